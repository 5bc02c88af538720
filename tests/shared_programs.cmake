# Tests that make the same bodies, which take longest to compile, share a program on the CPU. Each is still
# run by itself, except those over all formulations. Tests that are not named here have a program of their
# own. A program should fit into 4 GB of the compiler's memory.

# On GPUs these suites alone share a program, for CI to compile.
set(shared_on_gpu body/state law/user_law solver/trajectory)

# share(<program> <area>/<name>...)
function(share program)
  foreach(name IN LISTS ARGN)
    set(program_of_${name} ${program} PARENT_SCOPE)
  endforeach()
  set(shared_programs ${shared_programs} ${program} PARENT_SCOPE)
endfunction()

share(formulation/all
      formulation/patch formulation/rigid_motion formulation/derivatives formulation/balance)
share(shared/refinement
      adaptation/hanging_nodes adaptation/recovered_stress adaptation/refined_boundary
      adaptation/refinement_errors adaptation/refinement_inheritance adaptation/refinement_rules
      adaptation/refinement_transfer body/booked_energy body/patch_nodes constraint/conditions
      constraint/interpolation constraint/reactions solver/integrators solver/newton_refined topology/on_change)
share(shared/refinement_on_backend
      adaptation/refinement_on_backend solver/raised_bounds)
share(shared/criteria
      adaptation/calculated_criteria adaptation/combined_criteria adaptation/deformation_criteria
      adaptation/evaluate adaptation/force_intensity adaptation/rotation_criterion
      adaptation/shape_criteria adaptation/strain_and_stress_criteria constraint/press solver/damping
      solver/energy solver/free_body solver/lumped_bar solver/stable_step solver/trajectory)
share(shared/state
      adaptation/several_adaptations body/archive body/bad_input body/conditions
      body/contradictory_conditions body/failed_changes force/force_terms solver/between_steps
      solver/blow_up solver/energy_check solver/ledger solver/newton solver/recorded_steps
      solver/roll_back)
share(shared/switching
      adaptation/all_or_nothing adaptation/candidates adaptation/estimators_of_laws
      adaptation/folded_elements adaptation/lost_ellipticity adaptation/recorded_looks
      adaptation/screened_looks
      adaptation/refinement_internal_variables adaptation/stiffening adaptation/switching body/groups body/state)
share(shared/groups
      adaptation/bounded_criteria adaptation/ledger adaptation/switching_agreement
      adaptation/switching_statistics body/embedding body/internal_variables body/joined_bodies
      law/user_law)
share(shared/elements
      adaptation/discrepancies adaptation/other_elements adaptation/own_actions
      adaptation/recovered_stress_of_elements body/element_values element/shape_functions
      formulation/coefficients mesh/check mesh/generators mesh/joined mesh/loads mesh/middles
      topology/transfer)
share(shared/statics
      body/pressure solver/assemble solver/equilibrium_path solver/load_steps solver/static solver/static_loads solver/static_report)
share(shared/implicit
      solver/implicit solver/implicit_errors solver/implicit_state solver/schemes solver/without_matrix)
share(shared/preconditioners
      solver/multigrid solver/p_multigrid solver/preconditioners)
share(shared/laws
      law/closed_forms law/derivatives law/fibres law/invariance law/inversion law/limits
      law/plane_stress law/plane_stress_tangents law/plane_stress_values law/precision
      law/printed_energies law/ranges law/stretches law/tangents)
share(shared/points
      body/copy_values body/numbering element/cell math/dual math/eigenvalue_bounds math/functions math/matrix math/spectrum
      mesh/hilbert quadrature/exactness topology/group_numbers topology/shared_list)
share(shared/elements_alone
      formulation/inversion formulation/mass formulation/modes)

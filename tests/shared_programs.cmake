# Tests that make the same bodies, which take longest to compile, share a program on the CPU: two thirds of what a program
# compiles is in others, too. Each test is still run by itself, except those over all formulations. Tests that are not named
# here have a program of their own. A program should fit into 7 GB of the compiler's memory.

# On GPUs these suites alone share a program, for CI to compile.
set(shared_on_gpu body/state law/user_law solver/trajectory)

# share(<program> <area>/<name>...): the files of a program need names of their own, by which its tests are chosen.
function(share program)
  if(PLIANT_TESTS_APART)
    return()
  endif()
  set(file_names)
  foreach(name IN LISTS ARGN)
    get_filename_component(file_name "${name}" NAME)
    if(file_name IN_LIST file_names)
      message(FATAL_ERROR "${program} has two tests ${file_name}: let them be in different programs")
    endif()
    list(APPEND file_names "${file_name}")
    set(program_of_${name} ${program} PARENT_SCOPE)
  endforeach()
  set(shared_programs ${shared_programs} ${program} PARENT_SCOPE)
endfunction()

share(formulation/all
      formulation/patch formulation/rigid_motion formulation/derivatives formulation/balance)
share(shared/refinement
      adaptation/calculated_criteria adaptation/combined_criteria adaptation/deformation_criteria
      adaptation/endurance adaptation/evaluate adaptation/force_intensity adaptation/hanging_nodes
      adaptation/ledger adaptation/recovered_stress adaptation/refined_boundary adaptation/refinement_errors
      adaptation/refinement_inheritance adaptation/refinement_rules adaptation/refinement_transfer
      adaptation/rotation_criterion adaptation/shape_criteria adaptation/sleep_on_backend
      adaptation/strain_and_stress_criteria body/booked_energy body/patch_nodes
      constraint/conditions constraint/interpolation constraint/press constraint/reactions
      solver/damping solver/energy solver/free_body solver/integrators solver/lumped_bar
      solver/minres solver/newton_refined solver/stable_step solver/trajectory topology/hierarchy
      topology/on_change)
share(shared/refinement_on_backend
      adaptation/boundary_on_backend adaptation/refinement_on_backend body/elements_on
      body/merged_nodes body/refined_nodes solver/raised_bounds topology/changed_layout
      topology/known_facets topology/many_changes topology/shape)
share(shared/changed_meshes
      body/set_up topology/changed_meshes topology/degree topology/host_threads
      topology/refined_cells topology/restored_trees)
share(shared/switching
      adaptation/all_or_nothing adaptation/candidates adaptation/estimators_of_laws
      adaptation/folded_elements adaptation/lost_ellipticity adaptation/points_on_backend
      adaptation/recorded_looks adaptation/refinement_internal_variables adaptation/screened_looks
      adaptation/stiffening adaptation/switching body/groups body/rows_on body/state
      topology/tree_on topology/tree_on_coarsening)
share(shared/groups
      adaptation/bounded_criteria adaptation/several_adaptations
      adaptation/sleep_of_viscous_bodies adaptation/switching_agreement
      adaptation/switching_statistics body/archive body/bad_input body/conditions
      body/contradictory_conditions body/embedding body/failed_changes body/internal_variables
      body/joined_bodies body/values_by_place force/force_terms law/user_law solver/between_steps
      solver/blow_up solver/energy_check solver/ledger solver/local_steps_of_viscous_bodies
      solver/newton solver/recorded_steps solver/roll_back)
share(shared/elements
      adaptation/choice adaptation/discrepancies adaptation/other_elements adaptation/own_actions
      adaptation/recovered_stress_of_elements body/copy_values body/element_values body/numbering
      element/cell element/shape_functions formulation/coefficients formulation/inversion
      formulation/mass formulation/modes math/dual math/eigenvalue_bounds math/functions
      math/matrix math/spectrum mesh/check mesh/generators mesh/hilbert mesh/joined mesh/loads
      mesh/middles quadrature/exactness topology/group_numbers topology/shared_list
      topology/transfer)
share(shared/statics
      body/pressure solver/assemble solver/element_tangents solver/equilibrium_path solver/linear
      solver/load_steps solver/same_registers solver/static solver/static_loads
      solver/static_report)
share(shared/implicit
      adaptation/laws_and_meshes adaptation/mesh_within solver/implicit solver/implicit_errors
      solver/implicit_state solver/multigrid solver/p_multigrid solver/preconditioners
      solver/schemes solver/without_matrix)
share(shared/laws
      law/closed_forms law/derivatives law/fibres law/invariance law/inversion law/limits
      law/plane_stress law/plane_stress_tangents law/plane_stress_values law/precision
      law/printed_energies law/ranges law/stretches law/tangents)

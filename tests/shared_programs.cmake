# Tests that make the same bodies, which take longest to compile, share a program on the CPU. Each is still
# run by itself, except those over all formulations. Tests that are not named here have a program of their
# own. A program should fit into 4 GB of the compiler's memory, where it is not joined with others.

option(PLIANT_JOIN_TESTS
       "Join test programs that compile much the same: half the time, 8 GB each, minutes for one that changes" ON)
# More is compiled into each of these.
set(join_programs ON)
if(NOT PLIANT_JOIN_TESTS OR PLIANT_TEST_ALL OR PLIANT_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL Debug)
  set(join_programs OFF)
endif()

# On GPUs these suites alone share a program, for CI to compile.
set(shared_on_gpu body/state law/user_law solver/trajectory)

# share(<program> <area>/<name>...)
function(share program)
  foreach(name IN LISTS ARGN)
    set(program_of_${name} ${program} PARENT_SCOPE)
  endforeach()
  set(tests_of_${program} ${ARGN} PARENT_SCOPE)
  set(shared_programs ${shared_programs} ${program} PARENT_SCOPE)
endfunction()

# join(<program> <program or test>...): the first, which may be new, has the tests of the others too.
function(join program)
  if(NOT join_programs)
    return()
  endif()
  if(NOT program IN_LIST shared_programs)
    list(APPEND shared_programs ${program})
  endif()
  foreach(other IN LISTS ARGN)
    if(other IN_LIST shared_programs)
      list(REMOVE_ITEM shared_programs ${other})
      list(APPEND tests_of_${program} ${tests_of_${other}})
    else()
      list(APPEND tests_of_${program} ${other})
    endif()
  endforeach()
  set(shared_programs ${shared_programs} PARENT_SCOPE)
  set(tests_of_${program} ${tests_of_${program}} PARENT_SCOPE)
  foreach(name IN LISTS tests_of_${program})
    set(program_of_${name} ${program} PARENT_SCOPE)
  endforeach()
endfunction()

share(formulation/all
      formulation/patch formulation/rigid_motion formulation/derivatives formulation/balance)
share(shared/refinement
      adaptation/hanging_nodes adaptation/ledger adaptation/recovered_stress adaptation/refined_boundary
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
      adaptation/bounded_criteria adaptation/switching_agreement
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
      mesh/hilbert quadrature/exactness topology/facets_between topology/group_numbers topology/shared_list)
share(shared/elements_alone
      formulation/inversion formulation/mass formulation/modes)

# Two thirds of what they compile is the same.
join(shared/refinement
     shared/criteria adaptation/endurance adaptation/sleep_on_backend
     solver/minres topology/hierarchy)
join(shared/refinement_on_backend
     adaptation/boundary_on_backend adaptation/rules_on_backend body/elements_on body/merged_nodes body/refined_nodes
     topology/changed_layout topology/known_facets topology/many_changes topology/shape)
join(shared/changed_meshes
     topology/changed_meshes topology/degree topology/host_threads topology/refined_cells
     topology/restored_trees body/set_up)
join(shared/switching
     adaptation/points_on_backend body/rows_on topology/tree_on topology/tree_on_coarsening
     topology/tree_on_conversion topology/tree_on_splitting)
join(shared/types_on_backend
     adaptation/mixed_on_backend adaptation/degrees_on_backend adaptation/shapes_on_backend)
join(shared/groups
     shared/state adaptation/sleep_of_viscous_bodies body/values_by_place
     solver/local_steps_of_viscous_bodies)
join(shared/elements
     shared/elements_alone shared/points adaptation/choice)
join(shared/statics
     solver/element_tangents solver/linear solver/same_registers)
join(shared/implicit
     shared/preconditioners adaptation/laws_and_meshes adaptation/mesh_within)

# The tests of a program are chosen by the names of their files.
foreach(program IN LISTS shared_programs)
  list(TRANSFORM tests_of_${program} REPLACE ".*/" "" OUTPUT_VARIABLE file_names)
  set(each_once ${file_names})
  list(REMOVE_DUPLICATES each_once)
  if(NOT file_names STREQUAL each_once)
    message(FATAL_ERROR "two tests of ${program} have the same name: let them be in different programs")
  endif()
endforeach()

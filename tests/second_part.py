"""Tests of the second part: those that take long, and seldom find what the first part does not.

``./run test`` runs the first part; ``./run test --all`` both, as ``.ci/run`` does. A file or folder of the
second part that the command line names runs as any other does.
"""

SECOND_PART: dict[str, str | dict[str, str]] = {
    "docs": "every command of the tutorials and pages is run, and the site is built and opened in a browser",
    "benchmarks": "each study is run in small",
    "test_examples.py": "agents of other libraries learn",
    "test_machines.py": "processes of their own without a home, files, streams, memory",
    "test_network.py": "all processes of generation, training and evaluation are watched",
    "logic/browser": "pages are driven in a browser, and its solvers are compared with Python's",
    "vitruvius/test_demo.py": "the demo is run whole",
    "vitruvius/test_stopping.py": "commands are stopped at many times",
    "vitruvius/test_kills.py": {"test_no_kill_tears_a_file": "commands are killed at many times"},
    "logic/dataset/test_kills.py": "sets are made under kills",
    "logic/dataset/test_engine.py": {
        "test_a_node_that_is_killed_is_made_up_for_by_the_others": "Ray is started, on two nodes",
        "test_what_goes_wrong_in_tasks_is_raised_here_with_the_node_that_is_at_fault": "Ray is started",
        "test_a_cluster_here_listens_on_the_loopback_interface_alone": "Ray is started",
        "test_ctrl_c_keeps_what_is_done_and_ends_all_that_was_started": "Ray is started",
        "test_evaluations_and_jobs_of_studies_are_tasks_with_the_same_results": "Ray is started",
    },
    "logic/dataset/test_libraries.py": "pandas, polars, DuckDB, datasets and Croissant's reader are imported",
    "agent/play/test_play_display.py": "windows on a virtual display",
    "agent/report/test_page.py": "reports are driven in a browser",
    "agent/learning/test_ranks.py": "several processes learn as one",
    "agent/runs/test_runs.py": "runs are killed and go on",
    "agent/runs/test_export.py": "networks are run by another library",
    "agent/test_golden.py": "each preset learns for a while",
    "agent/planner/test_noise.py": "the planner in noisy worlds",
    "agent/planner/test_doors.py": "the planner behind closed doors",
    "agent/evaluation/test_task_figures.py": "evaluations of the tasks of furniture",
    "agent/baselines/driving/test_evaluation.py": {
        "test_it_learns_and_is_measured_beside_baselines_that_drive": "it learns",
    },
    "agent/evaluation/test_protocol.py": {
        "test_of_houses_that_an_agent_learnt_in_it_is_warned_with_their_number": "whole evaluations",
    },
    "agent/algorithms/map_completion/test_map_completion.py": {
        "test_windows_hold_the_four_cells_about_each_other_node": "large maps",
        "test_who_foresees_the_truth_finds_more_and_another_house_less": "many episodes",
    },
    "agent/algorithms/search/test_search.py": {
        "test_who_goes_by_true_values_finds_more_than_the_explorer": "many episodes",
        "test_a_run_learns_what_views_are_worth": "it learns",
    },
    "agent/algorithms/dqn/test_dqn.py": {
        "test_in_an_empty_room_it_learns_to_find_more_than_a_random_walk": "it learns",
    },
    "logic/grammars/test_grammars.py": {
        "test_every_rule_of_the_family_grammar_matters": "a grammar without each of its rules",
        "test_houses_of_every_grammar_keep_every_promise": "all grammars at all sizes",
    },
    "logic/proofs/test_explain.py": {
        "test_without_any_one_statement_of_a_conflict_there_is_a_house": "without each",
    },
    "logic/generation/test_straight_corridor.py": {
        "test_that_a_floor_of_many_alike_rooms_has_too_few_or_too_many_baths_is_proved": "a floor of a hotel",
    },
    "logic/generation/test_furnish.py": {
        "test_furniture_leaves_every_door_free_and_joined_to_all_the_floor": "many rooms",
    },
    "logic/generation/test_brief.py": {
        "test_no_dissection_is_preferred_where_a_brief_leaves_all": "hundreds of houses",
    },
    "logic/generation/test_dissections.py": {
        "test_a_void_is_free_where_the_rules_say_and_as_large_as_they_say": "large plans",
    },
    "logic/generation/test_thick_walls.py": {
        "test_other_topologies_and_units_have_such_walls": "every topology",
        "test_no_thickness_is_the_same_as_none_bit_for_bit": "every topology",
    },
    "logic/generation/test_door_widths.py": {
        "test_stars_units_and_own_plans_refuse_it": "grammars of their own",
        "test_without_such_clauses_houses_are_as_ever": "many houses",
    },
    "logic/generation/test_parts.py": {
        "test_a_plan_of_another_area_is_moved_as_little_as_can_be": "large plans",
    },
    "logic/generation/test_outdoor.py": {
        "test_in_a_plan_a_room_behind_a_patio_is_lit_from_there_or_by_its_door": "many plans",
    },
    "logic/generation/test_units.py": {
        "test_a_building_depends_on_the_rules_the_request_and_the_seed_alone": "large buildings",
        "test_a_building_keeps_all_that_its_grammar_promises": "large buildings",
        "test_what_no_building_has_is_proved_by_the_rules_of_its_flats": "large buildings",
    },
    "logic/generation/test_shared_walls.py": {
        "test_pieces_that_a_request_asks_for_stand_in_a_plan_or_are_proved_impossible": "many requests",
        "test_that_there_is_no_plan_is_proved_by_the_users_own_lines": "large plans",
        "test_nothing_is_refuted_that_has_a_solution": "systems by three solvers",
        "test_a_proof_names_the_line_that_says_who_opens_into_whom_or_needs_a_window": "many proofs",
    },
    "logic/workers/test_limits.py": {
        "test_a_join_of_very_many_values_is_named": "limits are waited for",
        "test_a_clause_that_computes_for_ever_is_named": "limits are waited for",
        "test_lint_lists_a_recursion_that_starts_at_furniture": "limits are waited for",
        "test_a_limit_of_a_search_names_the_rule_without_which_a_layout_is_found_and_is_kept": "waited for",
        "test_a_join_in_large_houses_alone_is_named_when_the_time_for_a_house_is_over": "it is waited for",
        "test_a_limit_names_the_stage_and_what_refuted_most_and_is_kept": "limits are waited for",
    },
    "logic/rules/test_relations.py": {
        "test_what_rules_say_of_rooms_is_so_in_the_plan": "every relation in every topology",
    },
    "logic/language/test_lint.py": {
        "test_rules_that_bind_only_in_larger_houses_or_beside_some_doors_draw_no_finding": "large grammars",
        "test_what_changes_no_rule_changes_no_finding": "every grammar",
        "test_the_shipped_grammars_are_clean": "every grammar",
    },
    "logic/language/test_recipes.py": {
        "test_a_recipe_does_what_its_title_says": "a grammar with each",
    },
    "logic/language/test_lengths.py": {
        "test_a_length_that_lint_lets_through_holds_in_what_is_made": "every length of every grammar",
    },
    "sim/backends/test_doors.py": {
        "test_an_episode_that_the_oracle_plays_equals_one_stepped": "many kernels",
        "test_a_state_that_is_restored_goes_on_bit_for_bit_also_in_another_environment": "many kernels",
        "test_paths_of_the_oracle_through_closed_doors_are_shortest": "against a search of all ways",
        "test_a_door_opens_after_its_steps_and_is_closed_again_in_the_next_episode": "many kernels",
        "test_rays_and_moves_meet_closed_doors_and_no_open_ones": "kernels of many configurations",
    },
    "sim/backends/test_backends.py": "a backend of the docs, in every autoreset mode",
    "sim/backends/test_exact.py": {
        "test_nothing_is_read_or_written_out_of_bounds": "kernels with every bound checked",
    },
    "sim/backends/test_original_collisions.py": "every collision that can be reached",
    "sim/test_far_houses.py": "kernels for houses far from the origin",
    "sim/tasks/test_memory.py": "kernels of tasks that remember",
    "sim/tasks/test_at_once.py": "kernels of several targets",
    "sim/world/test_varying.py": "kernels of what varies by episode",
    "agent/runs/test_watching.py": "runs are measured as they learn",
    "logic/proofs/test_typical.py": "many flats are furnished",
    "sim/backends/test_rays.py": {
        "test_a_million_rays_aimed_at_corners_equal_those_of_the_reference_and_none_leaks": "a million",
    },
    "sim/environment/test_observe.py": {
        "test_they_conform": "Gymnasium's checks",
    },
    "sim/test_compilers.py": "every kernel is compiled by both compilers",
    "sim/test_plans.py": {
        "test_the_searcher_finds_targets_behind_rooms": "long episodes",
    },
    "sim/test_runtime.py": "many processes and threads",
    "sim/tasks/test_furniture.py": {
        "test_a_habit_draws_targets_by_the_weights_that_it_states": "many targets",
        "test_rays_tell_the_named_kinds_of_the_pieces_that_they_end_on": "kernels of many configurations",
    },
    "sim/world/test_determinism.py": {
        "test_the_loop_by_environment_and_the_loop_by_ray_give_the_same_outputs": "many kernels",
        "test_an_environment_gives_the_same_outputs_alone_and_among_4096": "thousands of environments",
        "test_the_number_of_threads_changes_no_output": "processes with other numbers of threads",
    },
    "sim/world/test_episode_end.py": "every task in every autoreset mode",
    "sim/environment/test_libraries.py": "wrappers and other libraries",
    "sim/environment/test_wrappers.py": {
        "test_processes_are_forked_or_spawned_and_a_missing_gpu_changes_nothing": "processes import all anew",
    },
    "logic/workers/test_generate.py": {
        "test_requests_leave_no_descriptor_open_but_those_of_waiting_solvers": "several processes",
        "test_of_several_solvers_one_hears_what_clingo_remarks_on_in_the_same_rules": "several processes",
    },
    "logic/why/test_why_units.py": {
        "test_every_part_of_a_building_is_derived_from_facts_and_picks_by_rules_in_files": "a large building",
    },
    "logic/why/test_why_plans.py": {
        "test_every_part_of_a_plan_is_derived_from_facts_and_picks_by_rules_in_files": "a large plan",
    },
    "logic/proofs/test_short_proofs.py": {
        "test_a_plan_of_far_more_rooms_than_there_can_be_is_proved_impossible_in_few_lines": "a large plan",
        "test_a_proof_that_a_room_is_too_small_for_its_furniture_is_of_that_room_alone": "many proofs",
    },
}
"""Reasons why tests take long, by path below ``tests``: of a folder or a file, or by name of some tests in
it."""


def of_second_part(test: str) -> bool:
    """Return True if a test, such as ``logic/browser/test_watch.py::test_it[1]``, is in the second part."""
    path, _, name = test.partition("[")[0].partition("::")
    what = SECOND_PART.get(path)
    if isinstance(what, dict):
        return name in what
    return what is not None or any(path.startswith(f"{part}/") for part in SECOND_PART)

"""The pages promise nothing that no test holds: each such sentence has a row, with its tests."""

import ast
import re
from functools import cache

import pytest

from pages import ROOT

# Page; a part of a sentence as it stands there; the tests that fail if the sentence becomes false.
CLAIMS = r"""
README.md
  bit for bit, with any number of workers, on all x86-64 processors with AVX2
    test_every_task::test_a_seed_gives_the_same_states_twice
    test_certified_lists::test_the_expert_solves_the_first_instance_bit_for_bit
    test_same_in_every_process::test_same_bits_under_every_hash_seed
    test_check::test_scores_do_not_depend_on_the_number_of_workers
  all other values stay the same
    test_draws::test_one_attribute_alone_draws_what_it_draws_in_company
    test_holding_moves_nothing_else::test_holding_an_attribute_moves_no_other
    test_attribute::test_a_fourteenth_moves_no_draw
  the physics runs on the CPU either way, and is the same bit for bit
    test_fingerprint::test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not
    test_drawing_workers::test_a_dataset_is_the_same_with_drawing_workers
  written into the simulator and read back
    test_run::test_a_false_label_is_an_error_not_an_episode
  every attribute against a textbook law
    test_every_law::test_law
    test_every_law::test_a_broken_attribute_fails_its_proof
  checks every file, derives the physics again from the seeds
    test_verify::test_every_flipped_byte_is_reported_naming_the_file
    test_verify::test_a_label_that_lies_is_found
  no picture shows what to do
    test_physics_suite::test_props_that_differ_look_alike
    test_physics_suite::test_what_one_prop_hides_moves_nothing_that_is_seen
docs/architecture.md
  does not depend on the number of workers, nor on how often it was killed and resumed
    test_series::test_commits_do_not_depend_on_the_number_of_workers
    test_run::test_killed_runs_end_in_the_same_files
  so the draw does not depend on the scale
    test_draws::test_center_of_mass_is_redrawn_from_its_own_stream
    test_holding_moves_nothing_else::test_holding_an_attribute_moves_no_other
  So the look changes nothing that an attribute describes
    test_one_truth::test_pictures_are_taken_from_where_the_label_says
    test_protocols_in_force::test_what_is_only_seen_changes_no_state
  a protocol that asks for both is refused
    test_protocol::test_a_wrong_file_is_refused_by_name
  so they do not depend on the table's tilt and height
    test_audit_labels::test_a_world_follows_from_its_recipe_and_its_layout_from_the_seed_alone
    test_protocols_in_force::test_the_layout_of_a_seed_is_the_same_in_all_four
    test_objects::test_a_tilted_table_carries_everything_that_stands_on_it
docs/commands.md
  says what the collection would take, and does nothing
    test_dry_run::test_it_names_every_folder_and_writes_nothing
  progress and notes go to standard error
    test_screen::test_json_is_all_that_stands_on_standard_output
  refused: the message names the option, file, folder or disk that is the problem
    test_malformed_input::test_every_malformed_input_is_a_sentence
  less was made than requested; what was written is complete, and the same command continues
    test_plan::test_a_hopeless_task_is_given_up_and_its_rejections_are_kept
docs/dataset.md
  This imports no simulator
    test_dataset::test_needs_no_simulator
  a pickled episode is only a few hundred bytes
    test_dataset::test_pickles_small_after_use
  collected with this option can only be continued with it
    test_expert_robot::test_collections_with_and_without_it_do_not_mix
  records every seed twice with the same layout
    test_twins::test_a_pair_is_one_layout_under_two_physics
  A seed counts only if the expert succeeds both times
    test_twins::test_half_a_pair_is_no_episode
  a seed is kept only if the expert succeeds with every value
    test_sweeps::test_a_seed_is_kept_only_where_every_value_succeeds
    test_sweeps::test_a_sweep_is_sound_made_again_and_read_by_value
  that was tried is then stored for every value
    test_sweeps::test_with_failures_every_seed_is_there_with_every_value
  Datasets of another version are refused
    test_dataset_writer::test_foreign_manifest_is_refused
  leaves such episodes out, since nobody can reproduce them without the policy
    test_reproduce::test_what_a_policy_did_is_left_out
  restores all arrays, videos and labels to the last bit
    test_rewrite::test_there_and_back
    test_senses_file::test_conversion_there_and_back_loses_nothing
  Every reader and writer refuses a link inside a dataset
    test_hostile::test_some_hostile_datasets
    test_untrusted::test_a_link_on_the_way_is_named
  their files are the same with and without kept failures
    test_failures::test_the_episodes_are_the_same_without
  nothing else in the episode changes
    test_senses_file::test_everything_else_is_the_same_without_senses
    test_scene_renderer::test_colours_are_the_same_without_senses
  the command refuses before it starts
    test_plan::test_a_dry_run_answers_where_the_disk_is_too_small
  with the same bits each time
    test_pointcloud::test_the_same_picture_gives_the_same_bits
  Recording touch changes no state
    test_touch::test_recording_it_moves_nothing
  Pictures that were already there come out byte for byte
    test_render::test_with_nothing_changed_every_file_is_the_same
  if it does not, because rtphys has changed since, the command stops and says so
    test_render::test_states_that_are_not_those_of_the_label_are_not_drawn
  draws physics and look again from the seeds
    test_verify::test_a_label_that_lies_is_found
    test_check_draws::test_another_picture_or_piece_of_the_same_split_is_found
  Checksums are computed every time
    test_verify::test_what_was_sound_is_remembered_by_digest
  Exit code 0 means that the dataset is correct
    test_verify_command::test_the_digest_is_one_line_that_a_change_of_any_file_changes
    test_verify_command::test_a_damaged_dataset_has_no_digest_and_its_cure_is_named
  presents no digest as the dataset's own
    test_verify_command::test_a_damaged_dataset_has_no_digest_and_its_cure_is_named
    test_verify_command::test_what_was_not_made_again_as_it_is_has_no_digest
  by means other than reading back what was written
    test_audit_mutations::test_experiments_find_every_mutation_of_apply
    test_audit_mutations::test_a_read_back_that_lies_hides_nothing
  It names what it cannot measure, with the reason
    test_audit_episodes::test_what_could_not_act_is_told_and_not_measured
  The exit code is 1 if anything deviates
    test_audit::test_the_command_finds_labels_that_no_world_has
  a valid dataset at every instant
    test_writer_killed::test_a_kill_inside_a_commit_loses_nothing
    test_dataset_writer::test_full_disk_at_any_moment_loses_nothing
  the same bytes after any number of interruptions and with any number of workers
    test_writer_killed::test_killed_runs_end_in_the_same_dataset
    test_run::test_two_workers_one_of_them_killed_give_the_same_files
    test_many_real_workers::test_many_real_workers_give_what_one_gives
  Episode numbers follow the seeds
    test_dataset::test_lists_episodes_by_seed
  Two runs cannot use one folder at the same time
    test_dataset_writer::test_second_run_on_a_folder_names_the_first
  cannot be continued with other options or with another version
    test_dataset_writer::test_another_collection_is_refused_with_its_difference
  writes a file only if it has the listed SHA-256
    test_repair::test_what_comes_out_otherwise_is_not_written
  All other files stay as they are
    test_repair::test_what_is_damaged_comes_back_to_the_last_byte
  it refuses before it does any work, and names what differs
    test_repair::test_other_versions_are_refused_by_name
  one that was joined or cut cannot
    test_merge::test_other_seeds_of_one_task_are_joined_and_not_continued
    test_merge::test_a_subset_of_seeds_is_numbered_anew
  whether every number, label, sentence and picture of the export equals the dataset's
    test_lerobot_verify::test_a_number_that_differs_is_named
    test_lerobot_verify::test_a_label_or_sentence_that_differs_is_named
    test_lerobot_verify::test_a_picture_that_differs_is_named
  `export` never writes failures
    test_lerobot::test_failures_are_not_exported
  A killed export continues when the same command runs again
    test_lerobot::test_a_killed_export_goes_on
  A second export into the same folder is refused
    test_lerobot::test_a_second_export_to_one_folder_is_refused
  If an attribute is a number in some episodes only, the export is refused
    test_lerobot::test_a_number_in_some_episodes_alone_is_refused_with_its_name
  Memory use hardly grows with the number of episodes
    test_export_memory::test_memory_does_not_follow_the_number_of_episodes
docs/decisions.md
  the same seed gives the same bits on every machine
    test_path::test_same_input_same_bits
    test_trajectory::test_same_input_same_bits
    test_arithmetic::test_sums_end_in_the_bits_that_processors_with_avx2_share
docs/domains.md
  collected under one domain cannot be continued under another
    test_domain::test_episodes_verify_and_another_domain_does_not_continue_them
docs/evaluate.md
  An arm that cannot reach its target does not move; the record counts how often this happens
    test_policy_episode::test_an_arm_that_cannot_get_there_keeps_still_and_is_counted
  `evaluate` never searches for seeds itself
    test_evaluate::test_what_cannot_be_is_refused
  it must solve every certified instance
    test_evaluate::test_the_expert_solves_what_it_has_certified
    test_certified_lists::test_the_expert_solves_the_first_instance_bit_for_bit
    test_certified_lists::test_the_expert_still_moves_as_listed
  see nothing, and must fail on every task
    test_check::test_who_sees_nothing_solves_nothing
    test_every_task::test_nothing_comes_of_idling
    test_baselines::test_trembling_presses_nothing
  collected with `--set`, `--only` or `--domain` is refused
    test_evaluate::test_a_dataset_of_other_physics_is_no_list
  `--record` is refused, because the dataset would have gaps
    test_evaluate::test_what_was_run_without_recording_is_refused
  looks like a misspelling of one that your policy asked for when it was opened, the run is refused
    test_registry::test_a_misspelt_option_of_the_users_own_policy_is_named
  An exception in the policy makes that episode a failure
    test_evaluate::test_a_crash_of_the_policy_is_its_failure
  If the policy cannot be reached at all, the run stops
    test_evaluate::test_a_policy_that_is_gone_stops_the_run_and_can_be_resumed
  the same records with any number of workers
    test_evaluate::test_records_do_not_depend_on_workers_or_on_a_crash_between_them
    test_commands_with_many_workers::test_an_evaluation_and_what_it_records
  The same command continues where it stopped
    test_evaluate::test_a_kill_loses_no_record
    test_evaluate::test_a_killed_run_ends_up_with_the_same_summary
  an edited policy file, different weights or options are refused
    test_evaluate::test_a_folder_holds_one_evaluation
    test_registry::test_the_digest_follows_the_files_that_a_specification_names
  The same holds for a dataset of `--record`
    test_evaluate::test_a_recording_takes_no_episode_of_an_edited_policy
  uses no seed of the benchmark
    test_certified_lists::test_no_list_is_stale
  it extends a list and keeps its existing entries
    test_certify::test_a_finished_list_can_be_made_longer
  whatever the number of workers and interruptions
    test_certify::test_lists_do_not_depend_on_workers_or_wishes_and_say_what_the_expert_does
    test_certify::test_a_killed_run_ends_up_with_the_same_lists
  The list is then not written, the exit code is 4
    test_certify::test_a_lost_worker_is_no_verdict
    test_certify::test_the_command_names_the_seed_and_fails
  every list is stale, and `evaluate` refuses it
    test_fingerprint::test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not
    test_instances::test_a_fingerprint_says_what_keeps_a_list_from_being_used
  the list gets the current fingerprint and nothing else changes
    test_certify::test_a_stale_list_that_holds_gets_the_present_fingerprint_and_nothing_else
  the list stays stale, and the exit code is 1
    test_certify::test_a_list_that_differs_stays_stale_and_is_named
  must reach the same `state`
    test_certify::test_rows_that_come_out_otherwise_are_not_added_to
  so the order in which you request them does not matter
    test_certify::test_the_order_of_wishes_does_not_matter
  An evaluation refuses a list if the code, the task file, the domain
    test_instances::test_a_fingerprint_says_what_keeps_a_list_from_being_used
    test_evaluate::test_a_list_with_another_fingerprint_is_refused
  `changed_since_certified` in `summary.json` says so for each list
    test_summary::test_stale_lists_mark_the_summary_and_others_leave_none
  A list of another robot is always refused
    test_evaluate::test_a_list_of_another_robot_is_refused_whatever_is_accepted
  should be the same bits on every x86-64 processor with AVX2
    test_arithmetic::test_sums_end_in_the_bits_that_processors_with_avx2_share
    test_arithmetic::test_numpy_leaves_avx512_unused
  as in a training script that reads a dataset, changes nothing
    test_arithmetic::test_reading_a_dataset_changes_nothing_of_the_process
  gets a warning that names the remedy
    test_arithmetic::test_pinning_after_numpy_is_told_with_the_cure
  has a different digest on a machine, the lists are refused there
    test_evaluate::test_a_list_with_another_fingerprint_is_refused
  others are not paired, and `compare` says what differs
    test_compare::test_only_the_same_instances_are_paired
    test_compare::test_a_seed_with_other_physics_is_another_instance
docs/extend.md
  may only narrow the ranges of the one it extends
    test_load::test_a_child_may_only_narrow
  It has its own random stream, so no other value changes
    test_attribute::test_a_fourteenth_moves_no_draw
  becomes an error that names the file and the line
    test_attribute::test_what_an_attribute_raises_is_named_with_file_and_line
  An attribute without effect must fail a test
    test_own_attributes::test_its_own_proof_holds_and_fails_without_the_effect
docs/identify.md
  `--episodes` below 20 is refused
    test_identify::test_a_plan_that_cannot_be_is_refused
  the same for any number of workers, and after any number of interruptions
    test_identify::test_the_file_is_the_same_for_any_number_of_workers_and_after_interruptions
docs/install.md
  Without a Vulkan device everything except pictures works
    test_same_in_every_process::test_same_bits_where_nothing_can_draw
    test_reproduce::test_without_a_renderer_the_rest_is_compared
  the states are the same bits with and without one
    test_same_in_every_process::test_same_bits_where_nothing_can_draw
    test_fingerprint::test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not
docs/objects.md
  so that two builds give the same bytes
    test_build::test_two_builds_are_identical_whatever_the_number_of_workers
docs/physics.md
  The value has its own random stream, named after its key, and changes no other draw
    test_reach::test_a_prop_draws_from_its_own_stream
  every protocol draws it, and no severity narrows it
    test_reach::test_only_names_a_prop_or_the_whole_attribute
  `--set object_mass=2` changes nothing there, and `collect` says so
    test_dry_run::test_what_every_prop_has_of_its_own_is_left_with_nothing
  A `--sweep` of such an attribute is refused
    test_dry_run::test_a_sweep_without_effect_is_refused
  A different restitution would give the same episode, bit for bit
    test_audit_repeated::test_what_did_not_act_leaves_every_bit
  `acted` is false only if every state is the same, bit for bit
    test_audit_repeated::test_an_impact_that_nobody_saw_is_found
  No look moves the head camera
    test_one_truth::test_pictures_are_taken_from_where_the_label_says
    test_one_truth::test_a_label_says_where_its_height_comes_from
docs/physics_suite.md
  `'*'` and other patterns select only from the fifty
    test_library::test_a_suite_is_found_by_its_name_and_by_whole_names_alone
  neither a prop's name nor its position shows which one it got
    test_physics_suite::test_neither_name_nor_place_tells_which_is_which
docs/policies.md
  and are never run as code
    test_robotwin_root::test_overrides_are_literals_or_text
  Textures are always the unseen ones
    test_robotwin_root::test_textures_are_unseen_whatever_the_sentences_are
  An exception of the policy ends the run without a result
    test_robotwin_root::test_a_policy_that_raises_ends_a_launchers_run
  they equal those of lerobot's own loop, bit for bit
    test_lerobot_policy::test_a_real_checkpoint_acts_as_in_lerobots_own_loop
  `observe=chunk` draws pictures only when the queue of actions is empty
    test_lerobot_policy::test_every_action_has_an_observation_of_its_own_unless_a_chunk_is_to_share_one
  is refused before the first episode
    test_lerobot_policy::test_a_checkpoint_that_cannot_play_is_refused_before_any_episode
  If actions are not finite, or the policy raises an error, that episode is a failure
    test_lerobot_policy::test_an_error_is_the_episodes_and_the_next_one_goes_on
  If the connection is lost, the run stops
    test_openpi::test_a_server_that_dies_is_gone
  Observations hold the physics only with `show_physics=True`
    test_gym::test_physics_is_told_and_shown_only_on_request
  hold in every episode, including those that a vector environment begins by itself
    test_gym::test_conditions_of_make_last_and_those_of_reset_do_not
  A world that does not come to rest is skipped
    test_gym::test_a_world_that_does_not_come_to_rest_is_skipped
docs/protocols.md
  A seed has the same layout under every protocol
    test_protocols_in_force::test_the_layout_of_a_seed_is_the_same_in_all_four
  so holding or dropping one changes no other value
    test_holding_moves_nothing_else::test_holding_an_attribute_moves_no_other
    test_draws::test_a_removed_rule_moves_no_other_draw
  so holding one also decides the other
    test_draws::test_distance_and_angle_exclude_each_other
  draws the same relative point of each range under all severities
    test_protocol::test_a_severity_draws_the_same_point_of_narrower_ranges
  gives a seed the same physics and look in all tasks
    test_independent_worlds::test_paired_tasks_share_physics_and_look_but_no_layout
  `evaluate` cannot hold an attribute
    test_registry::test_no_option_is_taken_and_ignored
    test_main::test_what_cannot_work_is_one_clear_line
docs/releases.md
  Those of versions 1 and 2 are refused, and the message names their version
    test_dataset_writer::test_foreign_manifest_is_refused
  the old spelling works in this version, and prints the new one
    test_main::test_a_former_name_works_and_says_the_new_one
  `evaluate` refuses options that nothing would use
    test_registry::test_no_option_is_taken_and_ignored
docs/robots.md
  no other is evaluated on it, whatever `--accept-changes` says
    test_evaluate::test_a_list_of_another_robot_is_refused_whatever_is_accepted
  `openpi:` refuses a robot with another count
    test_openpi::test_a_robot_with_other_numbers_and_no_address_are_refused_before_a_server_is_asked
  A robot that is in two of these places is refused
    test_single_arms::test_a_library_holds_robots
  refuses the robot for the same reasons before it builds a world
    test_assets_command::test_an_unusable_robot_is_refused_before_a_world_is_built
docs/scale.md
  the same bytes with one worker, with thirty, on a Ray cluster, and after any number of kills
    test_many_workers::test_many_workers_give_what_one_gives
    test_many_real_workers::test_many_real_workers_give_what_one_gives
    test_remote::test_the_dataset_is_the_local_pools
    test_run::test_killed_runs_end_in_the_same_files
  Physics runs on the CPU in either case, and the states are the same bits
    test_fingerprint::test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not
  `collect` refuses a disk that has less free space than the tables say
    test_plan::test_a_dry_run_answers_where_the_disk_is_too_small
  an upper bound of the space
    test_dry_run::test_no_episode_that_was_measured_is_larger_than_the_bound
  An unknown key or name is refused, and the message suggests the nearest one
    test_manifest::test_a_mistake_is_named_with_its_place
  fewer run, and a line says so
    test_local::test_only_as_many_workers_as_memory_allows
  only attempts that were running, or that were waiting for an earlier seed, are made again
    test_run::test_a_resumed_run_gives_the_same_files
    test_many_real_workers::test_a_signal_ends_all_workers_at_once
    test_writer_killed::test_a_kill_inside_a_commit_loses_nothing
    test_dataset_writer::test_every_file_is_synced_before_its_row
  it uses more than 600 s of CPU time
    test_local::test_what_scale_md_says_that_a_job_may_use
    test_local::test_a_job_that_computes_for_ever_is_ended_twice_and_then_given_up
    test_local::test_a_job_that_always_kills_its_worker_is_given_up_and_the_others_are_done
    test_local::test_a_job_that_needs_too_much_memory_is_ended_twice_and_then_given_up
  or it makes no progress for 6000 s, the attempt has no result
    test_local::test_a_job_that_others_keep_from_its_end_is_no_result
    test_local::test_a_job_that_was_killed_from_outside_has_fewer_beside_it
  After six such losses the command stops with exit code 4
    test_local::test_what_scale_md_says_that_a_job_may_use
    test_local::test_a_job_that_others_keep_from_its_end_is_no_result
  An episode that exceeds it is tried again with nothing else running
    test_local::test_code_of_a_user_that_waits_for_ever_has_itself_to_blame
  The dataset is the same with and without
    test_drawing_workers::test_a_dataset_is_the_same_with_drawing_workers
  Each picture equals, to the pixel, the one that is drawn alone
    test_episode_render::test_what_is_drawn_together_is_what_is_drawn_alone
    test_camera_group::test_the_trial_counts_every_pixel_that_is_not_the_one_drawn_alone
  is worth requesting if a job has few cores
    test_drawing_workers::test_a_dataset_is_the_same_with_drawing_workers
  so each seed counts once even if it was tried several times
    test_remote::test_a_killed_worker_loses_nothing_and_doubles_nothing
  its attempt starts again elsewhere and is not rejected
    test_lost_node::test_a_lost_node_loses_nothing_and_doubles_nothing
  It refuses to work if anything differs, and names it
    test_remote::test_a_node_with_other_assets_or_versions_is_refused
  `merge` verifies every checksum
    test_merge::test_a_damaged_part
  It refuses parts that were collected with different options
    test_merge::test_parts_that_do_not_fit
    test_merge::test_parts_of_different_versions
  merging them gives, byte for byte, what the command without `--shard` writes
    test_merge::test_whole_tasks_join_to_the_same_bytes
  It also refuses parts that hold the same seed
    test_merge::test_parts_that_do_not_fit
  joins it as it is, and ends with exit code 4
    test_merge::test_a_part_that_is_unfinished_is_named
  `merge` joins them by seed
    test_merge::test_shards_that_share_a_task_join_by_seed
docs/sensitivity.md
  Both depend on the plan only, not on the number of workers or interruptions
    test_sensitivity::test_a_camera_cannot_matter_open_loop_and_a_lower_table_must
    test_commands_with_many_workers::test_many_workers_give_what_one_gives
  other options, another policy or an edited policy file are refused
    test_sensitivity::test_what_an_edited_policy_did_is_not_continued
docs/training_set.md
  State digests are the same on every x86-64 processor with AVX2, with any number of workers
    test_state_digests::test_pictures_the_layout_and_the_machine_do_not_count
    test_certified_lists::test_the_expert_solves_the_first_instance_bit_for_bit
    test_commands_with_many_workers::test_many_workers_give_what_one_gives
  `verify` compares each seed that both have tried
    test_state_digests::test_a_part_is_compared_seed_by_seed
docs/trust.md
  Reading one executes no code and unpickles nothing
    test_hostile::test_nothing_that_reads_can_unpickle_or_run_what_it_reads
  names the file, and takes bounded time and memory
    test_hostile::test_hostile_datasets
    test_hostile_hdf5::test_every_reader_refuses
    test_hostile_hdf5::test_a_heap_that_hdf5_would_never_end_reading
    test_untrusted::test_it_is_refused_in_one_sentence
  a server can do no more than act badly
    test_hostile_server::test_every_message_is_one_or_is_refused
    test_hostile_server::test_a_message_of_any_size_ends_the_connection
  no byte of any listed file changed, none is missing, none was added
    test_verify::test_every_flipped_byte_is_reported_naming_the_file
    test_verify::test_missing_and_cut_files
    test_verify::test_a_file_nobody_listed
  no attempt is missing between two others
    test_reproduce::test_a_removed_attempt_leaves_a_gap
  the chosen episodes are what the spec and the seed give, to the last bit
    test_reproduce::test_a_forgery_is_found
    test_reproduce::test_an_untouched_dataset_is_equal_to_the_last_bit
  this machine computes the same bits as the one that collected
    test_reproduce::test_a_forgery_is_found
  its states, actions and labels are those of a published collection
    test_state_digests::test_the_least_bit_of_a_state_counts
    test_state_digests::test_pictures_the_layout_and_the_machine_do_not_count
  States never depend on the renderer
    test_same_in_every_process::test_same_bits_where_nothing_can_draw
    test_fingerprint::test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not
  It is a problem if it does not crash or hang here
    test_reproduce::test_a_lost_worker_is_a_problem_unless_the_collection_lost_it_too
  are covered by no digest, and are then a problem
    test_verify_command::test_what_is_newer_than_the_manifest_is_covered_by_no_digest
"""
# A sentence with such words promises something that a user may rely on.
TELLTALE = re.compile(
    r"\bsame (bytes|bits|records)\b|\b(byte for byte|bit for bit)\b|\bany number of (w|i|k)"
    r"|\brefuse[sd]?\b|\bexit code\b|\bnothing else (in|changes)\b"
    r"|\b(moves?|changes) no(thing)?\b|\bnot depend on the number\b",
    re.IGNORECASE,
)
NO_PROMISES = {  # a part of the sentence -> why it needs no row
    "Its `encode_image_bit` passes all native pictures": "another program's",
    "With and without AVX-512 it writes the same bytes": "measured; no machine shows both",
    "`-c constraints.txt` gives the same bits": "measured on the systems that are named there",
    "To compute the same bits as the certified lists": "the same",
    "because with earlier versions HDF5 wrote files from memory": "another program's",
    "changes nothing for policies that ignore observations until then": "of those policies",
    "makes the launchers of FACT, Fast-WAM, Motus and Galaxea exit": "measured, of other programs",
    "its `MultiInputPolicy` refuses a mapping": "another program's",
    "**Gone**: `collect --estimate`": "says what there was",
    "(This was not kept: 1.1.0 refuses the datasets of 1.0.0.)": "the same",
    "what it refuses": "the head of a table",
}
PAGES = ("README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")))


def rows() -> dict[str, dict[str, list[str]]]:
    """By page and promise, the tests."""
    found: dict[str, dict[str, list[str]]] = {}
    promises, tests = dict[str, list[str]](), list[str]()
    for line in CLAIMS.strip().splitlines():
        match (len(line) - len(line.lstrip())) // 2:
            case 0:
                promises = found[line] = {}
            case 1:
                tests = promises[line.strip()] = []
            case _:
                tests.append(line.strip())
    return found


ROWS = rows()


@cache
def text_of(page: str) -> str:
    return " ".join((ROOT / page).read_text().split())


@cache
def functions_of(module: str) -> set[str]:
    (path,) = (ROOT / "tests").rglob(f"{module}.py")
    nodes = ast.walk(ast.parse(path.read_text()))
    return {node.name for node in nodes if isinstance(node, ast.FunctionDef)}


def sentences_of(page: str) -> list[str]:
    """Without code blocks. A cell of a table and an item of a list end a sentence, too."""
    text = re.sub(r"(?ms)^```.*?^```$", "", (ROOT / page).read_text())
    ends = r"\n\s*\n|\n\s*(?:\*|\d+\.)\s|\s\|\s|\|\n|(?<=[.?!])\*{0,2}\s+(?=[A-Z`*\[])"
    return [" ".join(sentence.split()) for sentence in re.split(ends, text)]


@pytest.mark.parametrize(
    ("page", "promise"),
    [(page, promise) for page, promises in ROWS.items() for promise in promises],
)
def test_a_promise_stands_on_its_page_and_its_tests_exist(page: str, promise: str) -> None:
    assert promise in text_of(page), "it is not said there any more: mend the row, and its tests"
    assert ROWS[page][promise], "it has no test"
    for test in ROWS[page][promise]:
        module, _, function = test.partition("::")
        assert function in functions_of(module), f"there is no {test}"


@pytest.mark.parametrize("page", PAGES)
def test_what_sounds_like_a_promise_has_a_row(page: str) -> None:
    known = [*ROWS.get(page, ()), *NO_PROMISES]
    sounds = [sentence for sentence in sentences_of(page) if TELLTALE.search(sentence)]
    assert not [one for one in sounds if not any(part in one for part in known)]


def test_each_sentence_without_a_promise_is_there() -> None:
    whole = " ".join(map(text_of, PAGES))
    assert not [part for part in NO_PROMISES if part not in whole]

#!/usr/bin/env bash
# Records every golden trace again, from the root of the repository. Run it only for a deliberate
# change of the model or of the trace format, since every build has to reproduce these files. The
# purpose of each scenario is in tests/tests/golden/, which checks it.
set -euo pipefail
cd "$(dirname "$0")/../.."

cargo build --quiet --release -p jcas-cli
jcas=${CARGO_TARGET_DIR:-target}/release/jcas

record() {
    local name=$1
    shift
    "$jcas" trace record --out "tests/golden/$name.jsonl" "$@"
}

record completion --uavs 20 --hotspots 7 --policy teams --pilot max --episode 2
record completion_on_horizon --uavs 20 --hotspots 7 --policy teams --pilot max --episode 2 \
    --set horizon_steps=31
record truncation --uavs 5 --hotspots 9 --policy greedy --pilot max --set horizon_steps=60
record paper_preset --preset paper --uavs 12 --hotspots 3 --policy teams --pilot max --episode 26 \
    --set charge_power_kw=3
record return_to_base --uavs 6 --hotspots 4 --policy greedy --pilot adaptive \
    --set initial_soc_min=0.21 --set initial_soc_max=0.3 --set horizon_steps=80
record charging_to_full --uavs 6 --hotspots 4 --policy random --pilot mid \
    --set initial_soc_min=0.9 --set initial_soc_max=1 --set charge_power_kw=2 \
    --set grid_width=3 --set grid_height=4 --set horizon_steps=40
record grounded --uavs 5 --hotspots 4 --policy greedy --pilot max \
    --set battery_capacity_kwh=0.0105 --set rtb_threshold_kwh=0 --set horizon_steps=40
record grounded_on_depot --uavs 4 --hotspots 3 --policy random --pilot min \
    --set initial_soc_min=0 --set initial_soc_max=0 --set horizon_steps=40
record link_on_threshold --uavs 8 --hotspots 6 --policy random --pilot max \
    --set link_throughput_min=1.0190404702277611 --set horizon_steps=40
record hidden_targets --uavs 9 --hotspots 4 --policy line --pilot adaptive \
    --set target_visibility=hidden --set radar_cross_section_dbsm=10
record symmetric_motions --uavs 5 --hotspots 3 --policy greedy --pilot max \
    --set motion_map=symmetric --set radar_cross_section_dbsm=10 --set horizon_steps=30 --episode 3
record one_uav --uavs 1 --hotspots 4 --policy greedy --pilot max \
    --set quorum=1 --set radar_cross_section_dbsm=10
record several_depots --uavs 8 --hotspots 5 --policy teams --pilot adaptive \
    --set "depots=[[1, 1], [10, 10], [10, 1]]" \
    --set initial_soc_min=0.21 --set initial_soc_max=0.29 --set horizon_steps=80
record narrow_grid --uavs 7 --hotspots 2 --policy random --pilot adaptive \
    --set grid_width=2 --set grid_height=9 --set neighbour_slots=3 --set horizon_steps=40
record search --preset search --uavs 8 --hotspots 5 --policy random --pilot max --episode 2 \
    --set uav_tag=index --set horizon_steps=60
record large_fleet --uavs 70 --hotspots 66 --policy teams --pilot adaptive \
    --set grid_width=32 --set grid_height=28 --set horizon_steps=16
record ten_uavs --uavs 10 --hotspots 4 --policy random --pilot max --episode 3 \
    --set sensing_range_m=10 --set quorum=2 --set logistic_slope_per_db=0.1 \
    --set link_throughput_min=1.2 --set grid_width=7 --set grid_height=5 \
    --set initial_soc_min=0.17 --set initial_soc_max=0.3 --set horizon_steps=24
record fifteen_uavs --preset paper --uavs 15 --hotspots 5 --policy random --pilot mid
record twenty_uavs --preset search --uavs 20 --hotspots 5 --policy line --pilot adaptive \
    --set horizon_steps=20
record coherent_pilots --uavs 12 --hotspots 4 --policy teams --pilot adaptive \
    --set pilot_gain=coherent --set radar_cross_section_dbsm=20 --set horizon_steps=40
record swerling1 --uavs 12 --hotspots 4 --policy teams --pilot adaptive \
    --set pilot_gain=coherent --set detection_curve=swerling1 --set false_alarm_probability=1e-4 \
    --set radar_cross_section_dbsm=20 --set horizon_steps=40
record swerling1_alone --uavs 3 --hotspots 4 --policy greedy --pilot max \
    --set detection_curve=swerling1 --set quorum=1 --set horizon_steps=60
record false_alarms --uavs 12 --hotspots 4 --policy teams --pilot adaptive \
    --set detection_curve=swerling1 --set pilot_gain=coherent --set radar_cross_section_dbsm=20 \
    --set false_alarm_per_cell=0.1 --set sensing_footprint_m=150 \
    --set reward_false_confirmation=-7 --set horizon_steps=40
record false_alarms_alone --uavs 3 --hotspots 4 --policy greedy --pilot max \
    --set false_alarm_per_cell=0.5 --set radar_cross_section_dbsm=40 --set horizon_steps=8
record reports --uavs 9 --hotspots 3 --policy teams --pilot adaptive \
    --set detection_curve=swerling1 --set pilot_gain=coherent --set radar_cross_section_dbsm=20 \
    --set false_alarm_per_cell=0.05 \
    --set sensing_footprint_m=100 --set report_levels=2 --set report_slots=5 \
    --set map_window_radius=2 --set horizon_steps=12
record detection_table --uavs 12 --hotspots 4 --policy teams --pilot adaptive \
    --set pilot_gain=coherent --set detection_curve=table --set logistic_slope_per_db=0.3 \
    --set "detection_table=[[20, 0.95], [60, 0.6], [120, 0.05]]" --set horizon_steps=40
record other_readings --preset paper --uavs 6 --hotspots 4 --policy random --pilot mid \
    --set quorum_window=episode --set learned_detections=all --set start_cells=random \
    --set false_alarm_per_cell=0.02 --set horizon_steps=60
short_of_charge=(--hotspots 16 --policy teams --pilot adaptive --set link_throughput_min=1.75
    --set battery_capacity_kwh=0.009 --set initial_soc_min=0 --set rtb_threshold_kwh=0
    --set hover_energy_kwh=0.0004 --set charge_power_kw=0.05 --set horizon_steps=10)
record forty_eight_uavs --uavs 48 "${short_of_charge[@]}"
record forty_nine_uavs --uavs 49 "${short_of_charge[@]}"
record hundred_uavs --uavs 100 --hotspots 33 --policy teams --pilot adaptive \
    --set link_throughput_min=1.75 --set initial_soc_min=0.3 --set horizon_steps=8

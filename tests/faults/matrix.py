"""The fault matrix: which fault, how it is injected, what is promised, and the tests that inject it and hold the promise.

A test is named as `tests()` finds it: a test of a program (GoogleTest, `Suite.Name`), or a method of a Python module
(`tests/daemon/faults_test.py:test_name`) that the ctest test beside it runs. `*` stands for each instance of a parameter.
"""

from dataclasses import dataclass, field

P, F, L, S, V = "pseudo-terminal", "changed input", "preloaded library", "signal", "virtual machine"
SIMULATED = "simulated time"  # the daemon's stages and health monitor on changed scans, without threads and devices


@dataclass(frozen=True)
class Row:
    number: int
    fault: str
    by: str
    promise: str
    tests: tuple
    bounds: dict = field(default_factory=dict)  # of what is measured, by its name: at most so much
    remark: str = ""


def matrix(*names):
    return tuple("FaultMatrix." + name for name in names)


def daemon(module, *names):
    return tuple(f"tests/daemon/{module}_test.py:test_{name}" for name in names)


def live(name):
    return (f"tests/faults/live_test.py:test_{name}",)


def guest(module, *names):
    return tuple(f"tests/hil/{module}_test.py:test_{name}" for name in names)


COMBINED = live("rows_2_8_34_and_41_the_line_the_process_and_the_processor")

ROWS = (
    Row(1, "laser silent for 10 s while the robot drives", SIMULATED,
        "flag <= 2 T; OK <= 2 s after; <= 0.10 m from the run without fault",
        matrix("Row01SilenceOfTenSecondsWhileTheRobotDrives"), {"flag": 2.0, "recover": 2.0, "error": 0.10},
        "lost, and says so, until the search has found it and scans have confirmed it"),
    Row(2, "laser silent for ever", P, "flag <= 2 T; the daemon lives; opened anew every 2 s at most; CPU < 5 %", COMBINED +
        ("LrfSource.OpensADeadLineAnewEveryTwoSecondsAndTellsOfItOnceAnOutage",), {"flag": 2.0, "CPU": 5.0}),
    Row(3, "laser unplugged and plugged in again", f"{P}, {V}", "flag <= 2 T; back <= 1 s after it returns",
        daemon("daemon", "flags_a_laser_that_dies_within_two_periods_and_has_it_back_within_a_second")
        + guest("usb", "the_daemon_reads_a_laser_through_the_kernels_driver_and_survives_unplugging"),
        {"flag": 0.05, "recover": 1.0}),
    Row(4, "EIO, EINTR, EAGAIN on read", L, "no crash, no busy loop", live("row_4_reads_of_the_line_that_fail"),
        {f"CPU with {name}": 30.0 for name in ("EINTR", "EAGAIN", "EIO")}),
    Row(5, "one byte at a time; split at random", F, "the same scans",
        ("ScipRobustness.AnySplitGivesTheSame", "SickRobustness.AnySplitGivesTheSame",
         "RplidarRobustness.AnySplitGivesTheSame", "LdrobotPacket.AnySplitGivesTheSame", "YdlidarPacket.AnySplitGivesTheSame")),
    Row(6, "one byte flipped, dropped, inserted or doubled anywhere", F, "at most one scan lost",
        ("ScipRobustness.OneDamagedByteAnywhereCostsAtMostOneScan", "SickRobustness.OneDamagedByteAnywhereCostsAtMostOneScan",
         "RplidarRobustness.OneDamagedByteAnywhereCostsAtMostOneScan")),
    Row(7, "many wrong bytes", F, "no crash; wrong scans <= 1e-4", ("ScipRobustness.ManyWrongBytesGiveNoWrongScan",), {},
        "as many as that test has, not for 60 s"),
    Row(8, "endless garbage at full speed", P, "flag <= 2 T; deadlines of the other threads kept", COMBINED,
        {"flag": 2.0, "missed": 0.0}),
    Row(9, "frame cut, then the next one", F, "one frame lost",
        ("Lasers/LrfContract.HearsNothingInHalfPackets/*", "Lasers/LrfContract.HearsNothingWrongInBytesThatAreMissing/*")),
    Row(10, "other number of beams and angle range", SIMULATED, "handled, or rejected and counted",
        matrix("Row10AnotherNumberOfBeamsAndAnotherRange"), {"recover": 1.0}),
    Row(11, "no beam returns", SIMULATED, "flag <= 3 T; map not updated", matrix("Row11NoBeamReturns"), {"flag": 3.0}),
    Row(12, "half of the beams blind", SIMULATED, "flagged, or error <= 2 x nominal", matrix("Row12HalfOfTheBeamsAreBlind"),
        {"error": 2.0}),
    Row(13, "the same scan for ever", SIMULATED, "flag (<= 5 T)",
        matrix("Row13TheSameScanAgainAndAgain", "Row13TheSameScanWithLessThanTheLasersNoise"), {"flag": 5.0}),
    Row(14, "bias of 5 cm, scale of 2 %", SIMULATED, "flagged, or error bounded and stated",
        matrix("Row14RangesAreTooLongByFiveCentimetresOrTwoPercent"),
        {"error of 5 cm bias": 0.15, "error of 2 % scale": 0.15}),
    Row(15, "10 % of the beams are spikes", SIMULATED, "error <= 1.2 x nominal", matrix("Row15TenPercentOfTheBeamsAreSpikes"),
        {"error": 1.2}),
    Row(16, "repeated stamp", SIMULATED, "dropped and counted; all finite", matrix("Row16RepeatedStamps")),
    Row(17, "out of order by 1 to 5 scans", SIMULATED, "dropped or reordered; no step back",
        matrix("Row17OutOfOrderByUpToFiveScans")),
    Row(18, "scans late by 0.6, 3 and 10 s", SIMULATED, "not fused; flag <= 2 T", matrix("Row18LateScans"),
        {f"flag of {late} s": 2.0 for late in ("0.6", "3", "10")}),
    Row(19, "wall clock jumps by an hour", L, "estimate identical to the bit", live("row_19_the_wall_clock_jumps_by_an_hour"), {},
        "in a replay on the daemon's threads; on a robot by a library, not by setting the machine's clock"),
    Row(20, "device clock drifts, resets, wraps", F, "tracked; no jump",
        ("ScipSession.StampsAreRightInSpiteOfDriftJitterAndWrap", "DeviceClock.AResetCostsTwoScansAndMakesNoJump",
         "DeviceClock.ACounterThatWasSetBackForSecondsIsSeenAfterEightScans")),
    Row(21, "more scans than there is time for", F, "newest wins; each drop counted; latency <= 0.7 s",
        live("row_21_more_scans_than_there_is_time_for"), {"late": 0.7}, "a log of 40 Hz played at 800 Hz"),
    Row(22, "worst scans for the matcher", F, "budget kept; best so far, flagged",
        ("bench.deadline", "MatcherLoop.EndsAnyMatchWithinItsBudget", "NdtMatcher.DeadlineAlreadyOverStillGivesAnAnswer")),
    Row(23, "corridor without features, 30 m", SIMULATED, "flag <= 5 T; across <= 0.05 m; heading <= 1 deg",
        matrix("Row23FeaturelessCorridor"), {"flag": 5.0, "error across": 0.05, "heading": 1.0}),
    Row(24, "nothing in range", SIMULATED, "DEGRADED <= 3 T; no false correction", matrix("Row24NothingInRange"), {"flag": 3.0}),
    Row(25, "carried off by 3 m and 90 deg in a known map", SIMULATED, "LOST <= 2 s; found <= 10 s in >= 95 %; never OK while wrong",
        ("Kidnapped.KnowsItWithinTwoSecondsAndFindsItselfWithinTen",), {"flag": 2.0, "recover": 10.0},
        "the worst of three runs; ODOLESS_KIDNAPPINGS asks for more"),
    Row(26, "symmetric room", SIMULATED, "several hypotheses kept, or flagged",
        ("Kidnapped.StaysLostWhereTwoPlacesLookAlike", "GlobalSearch.SeesTheTwinOfEveryPoseInASymmetricRoom")),
    Row(27, "people in front of 40 % of the beams", SIMULATED, "error <= 1.5 x nominal",
        matrix("Row27PeopleHideFortyPercentOfTheBeams"), {"error": 1.5}),
    Row(28, "spin at 360 deg/s, laser of 10 Hz", SIMULATED, "heading <= 1 deg at the end",
        matrix("Row28SpinAt360DegreesASecond"), {"heading": 1.0}, "each scan taken at once, not beam by beam"),
    Row(29, "tilt servo stalled, or its answers wrong", f"{P}, {V}", "flagged; stop <= 200 ms; 2D SLAM goes on",
        daemon("daemon", "goes_on_with_a_servo_that_stalls_or_dies_and_says_so",
               "says_that_answers_of_the_servo_are_wrong_and_goes_on")
        + guest("stop", "an_edge_and_a_lost_line_stop_the_moving_servo_within_200_ms")),
    Row(30, "CAN link down, error frames, ENOBUFS, flood of id 0", V, "back <= 1 s after the bus returns",
        guest("can", "a_link_that_goes_down_and_up_is_used_again_within_a_second",
              "error_frames_and_a_flood_of_id_0_are_survived"), {}, "a virtual bus has no real bus-off"),
    Row(31, "GPIO chip gone, line stuck", f"{V}, {L}", "flagged; safe output",
        guest("gpio", "the_emergency_stop_is_fail_safe")
        + ("GpioThread.AStopLineThatIsNotThereIsAStop", "GpioThread.ARoundThatDoesNotEndIsAStop")),
    Row(32, "LCM network down, socket full, loss, flood", F, "real-time threads never wait; drops counted",
        ("LcmLink.GoesOnWithoutANetworkAndStillRecords", "LcmReceiverNetwork.WaitsAsLongAsItIsToldEvenInAFloodOfOthers",
         "LcmReceiverNetwork.CountsEveryDatagramOnceAndWhatIsMissing") + daemon("split", "lost_datagrams_cost_little")),
    Row(33, "crafted LCM datagrams", F, "no crash; refused and told",
        ("ParseDatagram.RefusesAllElse", "Decoders.AcceptOnlySaneRecordsFromMutatedMessages")
        + daemon("split", "forged_motions_are_refused_and_said")),
    Row(34, "SIGSTOP for 0.1, 0.5 and 2 s", S, "stale scans dropped; OK <= 1 s after; no burst", COMBINED,
        {"recover at the start of a run": 1.0} | {f"recover of {stopped} s": 1.0 for stopped in ("0.1", "0.5", "2.0")},
        "a robot at rest; in the first 5 s of a run a stop of 2 s takes longer to be OK: no match score is usual yet"),
    Row(35, "a stage hangs", S, "ends by the watchdog <= 0.5 s and the saving; OK again <= 3 s",
        daemon("faults", "saves_what_is_known_when_a_stage_hangs"), {"flag": 0.5, "recover": 3.0},
        "pipeline.watchdog_ms is 2000 by default; restarted by hand here"),
    Row(36, "kill -9 and power cuts at random times", S, "<= 2 s of map lost; no unreadable file; pose back <= 3 s",
        daemon("world", "a_kill_or_power_cut_at_any_moment_loses_two_seconds_at_most")
        + daemon("outputs", "a_kill_at_any_moment_leaves_whole_results_alone"), {"lost": 2.0, "pose back": 3.0}),
    Row(37, "disk full, read-only, EIO on fsync", L, "runs on; what was saved stays; flagged",
        daemon("world", "goes_on_beside_a_full_disk", "goes_on_beside_a_read_only_disk", "goes_on_beside_a_broken_disk")
        + daemon("outputs", "a_full_disk_damages_nothing_and_is_told_until_there_is_room",
                 "a_broken_disk_damages_nothing_and_is_told_until_it_works")),
    Row(38, "world file corrupt", F, "refused with the reason, or what is whole is used",
        ("World.OutlivesDamage", "World.SaysWhatIsWrongInIt") + daemon("world", "refuses_what_is_no_world")),
    Row(39, "configuration: each key of wrong type, out of range, unknown", F, "exit 78 with key, unit and range; no device opened",
        ("ParseParameters.RefusesAWrongTypeOfEveryKey", "Values/ParseParametersMistake.IsNamed/*", "UnknownKeys/ParseParametersMistake.IsNamed/*",
         "ParseParameters.AcceptsOrRefusesWhateverAMutationGives")
        + daemon("daemon", "says_what_is_wrong_with_its_configuration_or_arguments")),
    Row(40, "real time refused; no memory, threads, files at the start", "limits", "clear exit, or published as degraded",
        daemon("faults", "says_that_memory_does_not_suffice", "says_that_descriptors_do_not_suffice",
               "says_that_threads_do_not_suffice", "is_not_ok_where_real_time_is_refused",
               "ends_where_real_time_is_required_and_refused")),
    Row(41, "four processes that compute, one that fills memory", "load", "misses told; the next scan <= 1 T after", COMBINED,
        {"recover": 1.0}),
    Row(42, "NaN, infinite, negative, denormal ranges and numbers", SIMULATED, "refused at the boundary; poses finite",
        matrix("Row42NumbersThatAreNone") + ("DecodeMotion.RefusesEveryNumberThatIsNone", "DecodeScan.TakesWhatIsNoRangeForAnUnknownOne")),
)

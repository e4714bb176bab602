# SPDX-License-Identifier: BSD-3-Clause
"""Simulated falls in a room mapped before: how soon is the robot relocalised?"""
import json
import math
import random
import statistics

from bench_report import call
from bench_runs import PROGRAMS, Runs

# The path of loop_room without its last legs.
LEGS = ((2.0, 1.7), (4.4, 1.5), (6.5, 1.9), (7.0, 3.4), (6.2, 5.2), (4.4, 5.1), (2.5, 4.6), (2.0, 3.0))
ROOM_SEED = 2
COUNT = 20
SECONDS = 7.0
# The simulator's robot: it stands, makes a step, waits, and then walks and falls.
STAND_S, STEP_S, STEP_M = 1.0, 0.75, 0.05
WALK_S = 0.75
SEEN_BEFORE_S = 1.1  # walking included
MOST_ASIDE_M = 0.15
MOST_WAIT_S = 60.0  # people are somewhere else at every time
MOST_SKIP_M, MOST_TURN_DEG = 0.8, 90.0


def fall_clips(seed=8):
    """Arguments of posefusion_simulate, a list for each fall: kinds in turn, turns over the whole
    range, to either side, and the rest at random."""
    chance = random.Random(seed)
    turns = [MOST_TURN_DEG * (i + 0.5) / COUNT for i in range(COUNT)]
    chance.shuffle(turns)
    return [fall_clip(chance, i, turn) for i, turn in enumerate(turns)]


def fall_clip(chance, index, turn_deg):
    leg = index % (len(LEGS) - 1)
    (x, y), (goal_x, goal_y) = LEGS[leg], LEGS[leg + 1]
    length = math.hypot(goal_x - x, goal_y - y)
    ahead = (goal_x - x) / length, (goal_y - y) / length
    aside, along = chance.uniform(-MOST_ASIDE_M, MOST_ASIDE_M), chance.uniform(0, length - 1.2)

    def place(s):
        return [round(x + s * ahead[0] - aside * ahead[1], 3),
                round(y + s * ahead[1] + aside * ahead[0], 3)]

    wait_s = round(chance.uniform(1, MOST_WAIT_S), 2)
    at_s = STAND_S + STEP_S + wait_s + WALK_S
    fall = {"at_s": round(at_s, 2), "to": ("forward", "backward", "sideways")[index % 3],
            "lie_s": round(chance.uniform(0.1, 0.4), 2),
            "skip_m": round(chance.uniform(0, MOST_SKIP_M), 2),
            "turn_deg": round(chance.choice((-1, 1)) * turn_deg, 1)}
    waypoints = [place(along - STEP_M), place(along), place(length + 0.01)]
    return ["--start", f"{at_s - SEEN_BEFORE_S:.2f}",
            "--set", f"camera.waypoints={json.dumps(waypoints)}", "--set", f"camera.pause_s={wait_s}",
            "--set", f"camera.falls={json.dumps([fall])}"]


class Falls(Runs):
    def fall_check(self, sequence, status, *arguments):
        """How the camera came back after each fall of a sequence."""
        return json.loads(call(PROGRAMS / "posefusion_fall_check", sequence, status, *arguments))

    def get_up(self):
        """The robot walks in a room that was mapped before, falls, and gets up elsewhere."""
        room, folder, _ = self.walk_run("loop_room", ROOM_SEED, "recorded")
        map_file = folder / "map.pfdb"
        falls = []
        for i, changes in enumerate(fall_clips()):
            name = f"loop_room_{ROOM_SEED}_fall_{i:02d}"
            clip = self.simulated("loop_room", ROOM_SEED, SECONDS, *changes, name=name)
            status = self.output / f"{name}_run" / "status.csv"
            self.run(f"{name}_run", clip, "--detector", "recorded", "--map", map_file,
                     "--localize-only", "--save-status", status)
            falls += self.fall_check(clip, status, "--map", map_file, "--map-sequence", room)
        self.fall_rows(f"{len(falls)} falls in the map of loop_room {ROOM_SEED}", falls)

    def fall_rows(self, name, falls):
        """The figures of posefusion_fall_check for some falls, with the bars."""
        found = [fall for fall in falls if fall["tracking_after_s"] is not None]
        self.row(f"{name}: found", len(found), f"of {len(falls)}", len(falls), most=False, digits=0)
        self.row(f"{name}: held on to throughout", sum(not fall["lost"] for fall in falls), "", digits=0)
        # A robot that is not found although 80 % of its view are in the map exceeds any bar.
        seen = [fall for fall in falls if not fall["lost"] or fall["map_in_view_after_s"] is not None]
        times = [math.inf if fall["time_to_tracking_s"] is None else fall["time_to_tracking_s"]
                 for fall in seen]
        self.row(f"{name}: the map came into view by 80 %", len(seen), f"of {len(falls)}", digits=0)
        if times:
            self.row(f"{name}: from there to tracking, median", statistics.median(times), "s", 0.5,
                     digits=2)
            self.row(f"{name}: from there to tracking, worst", max(times), "s", 2, digits=2)
        for when, known, posed, bar in (
                ("once it is up", "known_frames_once_up", "of_these_with_a_pose", 85),
                ("since the loss", "known_frames_since_loss", "of_them_with_a_pose", None)):
            frames = sum(fall[known] for fall in falls)
            if not frames:
                continue
            share = 100 * sum(fall[posed] for fall in falls) / frames
            self.row(f"{name}: frames {when} with a pose, of those with 60 % in the map", share, "%",
                     bar, most=False, digits=1)
        self.row(f"{name}: wrong poses", sum(fall["wrong_poses"] for fall in falls), "", 0, digits=0)
        self.row(f"{name}: pose farthest from the truth",
                 max(fall["worst_from_truth_m"] for fall in falls), "m", digits=3)

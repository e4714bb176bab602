# SPDX-License-Identifier: BSD-3-Clause
"""Simulated rooms in which things are moved: what is left of them in the map at the end, how soon it follows, and the
cost for the trajectory."""
import json

from bench_people import EMBEDDED
from bench_report import call
from bench_runs import PROGRAMS, Runs, note


class Things(Runs):
    def movers(self):
        self.moved_things("movers_light")

    def office_day(self):
        self.moved_things("office_day_light")

    def moved_things(self, scenario):
        for seed in self.options.seeds:
            sequence = self.simulated(scenario, seed)
            still = self.simulated(scenario, seed, None, "--set", "things_move=false",
                                   name=f"{scenario}_{seed}_nothing_moved")
            name = f"{scenario} {seed}, embedded"
            folder, summary = self.run(f"{sequence.name}_masks", sequence, *EMBEDDED, "--save-masks")
            without = self.run(f"{still.name}_run", still, *EMBEDDED)[1]
            self.map_rows(name, self.evaluate("things", folder, sequence))
            self.row(f"{name}: ATE, against the same with nothing moved",
                     summary["ate_rmse_m"] / without["ate_rmse_m"], "x", 1.1, digits=2)
            note(f"watching the things of {sequence.name}")
            moves = json.loads(call(PROGRAMS / "posefusion_mover_check", sequence, *EMBEDDED, "--json"))
            self.place_rows(f"{name}: old place forgotten", [move["left"] for move in moves], 1)
            self.place_rows(f"{name}: new place mapped", [move["taken"] for move in moves], 3)

    def map_rows(self, name, found):
        self.row(f"{name}: surfels on things that moved", 100 * found["share"], "%", 1, digits=3)
        masks = found["masks"]
        self.row(f"{name}: static pixels masked", 100 * masks["masked_of_what_stands"], "%", 0.5, digits=2)
        self.row(f"{name}: pixels of moving things masked", 100 * masks["masked_of_moving_things"], "%",
                 digits=1)

    def place_rows(self, name, places, bar):
        """How long the camera had to look until the map had followed."""
        seen = [place for place in places if place["seen_after_s"] is not None]
        followed = [place for place in seen if place["told_after_s"] is not None]
        self.row(f"{name}, of those seen", len(followed), f"of {len(seen)}", len(seen), most=False, digits=0)
        if followed:
            self.row(f"{name}, after being in view for, worst",
                     max(place["of_it_in_view_s"] for place in followed), "s", bar, digits=2)

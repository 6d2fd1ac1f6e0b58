#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every key of job and cell, changed once: a plan over the checkpoints of the job before the change is byte for byte
that of --fresh. A few keys; all with MILLPOSE_KEYS=all. Usage: keys_test.py MILLPOSE TOP"""
import copy
import json
import os
import shutil
import sys
import unittest

import resolved_yaml
from cli_fixture import FEW, JOB, MILLPOSE, TOP, InFolder, plan, run, tree

ALL = os.environ.get("MILLPOSE_KEYS") == "all"
FEW_KEYS = {"process.spindle_rpm", "process.cutting.width_mm", "gaps.retract_mm", "path.rotation_step_deg",
            "arm.joint_stiffness_Nm_per_rad", "bodies[].pose.xyz_mm", "controllers.krl.advance",
            "process.min_feed_share", "program_options.path_tolerance_mm"}
# Keys that no change is made to, and why.
LEFT_OUT = {
    "millpose_job": "the version", "millpose_cell": "the version",
    "toolpath.region.step_faces": "of STEP parts",
    "toolpath.region.all[].step_faces": "of STEP parts", "toolpath.region.any[].step_faces": "of STEP parts",
    "toolpath.region.none[].step_faces": "of STEP parts",
    "toolpath.cam.rotary_axes[].axis": "of G-code", "toolpath.cam.rotary_axes[].carries": "of G-code",
    "toolpath.cam.rotary_axes[].direction": "of G-code", "toolpath.cam.rotary_axes[].point_mm": "of G-code",
    "toolpath.cam.circle": "of G-code", "toolpath.cam.kinematics_codes.*": "of G-code",
    "toolpath.cam.tip_programming": "of G-code",
    **{f"toolpath.cam.{key}": "of APT and G-code"
       for key in ("sender", "unit", "frame", "cycle_point", "offsets_mm.*", "section", "spindle")},
    "arm.urdf.base_link": "an arm like any other once derived", "arm.urdf.file": "an arm like any other once derived",
    "arm.urdf.flange_link": "an arm like any other once derived",
    "arm.urdf.packages.*": "an arm like any other once derived",
    "arm.urdf.tolerance_mm": "an arm like any other once derived",
    "arm.coupled_limits_deg[].a": "one that binds and leaves home is test_pipeline's (CoupledLimits)",
    "arm.coupled_limits_deg[].at_most": "one that binds and leaves home is test_pipeline's (CoupledLimits)",
    **{f"arm.dh.{key}": "an arm like any other once derived"
       for key in ("convention", "tolerance_mm", *(f"rows[].{of}" for of in ("a_mm", "alpha_deg", "d_mm", "theta_deg", "sign")))},
    "arm.family": "another arm altogether (cli_parallel_arm)", "arm.lengths_mm.d5": "of parallel axes alone",
    "reproduction_only": "such cells get no programs", "cell": "another name of the same file",
    **{f"workpiece.registered.{key}": "no pose but its uncertainty, for summary.json alone (cli_register)"
       for key in ("pose.xyz_mm", "pose.abc_deg", "centre_mm", "covariance_mm_mrad", "bending.covariance_mm_mrad")},
    "workpiece.registration.tolerance_mm": "a bound on that (cli_register)",
    "workpiece.registration.max_bending_mm": "a bound on that (cli_register)",
    "tools_file": "another name of the same tools (cli_tools)",
    "tool_held": "of a job's operations (cli_operations)",
    "compensation.map_csv": "another name of the same file (cli_register)",
    "controllers.linuxcnc.m6_moves": "true is refused where programs have M6",
    "workpiece.stock.unit": "a stock of another size touches at home",
    "toolpath.drill.circles.diameter_mm": "of another diameter there is no hole",
    "pose.objective.force": "of an objective that another program holds (cli_python)",
    "pose.objective.expression": "stands in place of a name (cli_expression)",
    "toolpath.strategy": "each has keys of its own: the variants",
    "operation": "a name for people", "operation_of": "a name for people",
    "interference.far_bodies": "bodies so far away are told, and refused without it", "tool.cutter.centre_cutting": "a bound, tested with what it bounds",
    "tool.cutter.max_ramp_deg": "a bound, tested with what it bounds",
    "external_axes[].name": "known by its name elsewhere", "external[].axis": "has a unit of its own", "bodies[].axis": "the names of external_axes",
    "external_axes[].kind": "has keys of its own", "external[].scope": "the variants",
    "interference.unchecked_links": "links that have bodies are refused there",
}
# What a name may be changed to where it has to be one that is known.
OTHER_NAMES = {"pose.objective.name": "isotropy", "process.cutting.material": "TiAl6V4", "tool": "other", "arm.deviations.date": "2026-02-03", "excluded_pairs": [["far0", "far2"]]}
TEXTS = ("coolant_off", "coolant_on", "footer", "header", "pass_begin", "pass_end", "spindle_off", "spindle_on",
         "tool_change")
WIDE = {
    "box": {"lower_mm": [-900, -900, -900], "upper_mm": [900, 900, 900]},
    "half_space": {"point_mm": [0, 0, -900], "normal": [0, 0, 1]},
    "polygon": {"points_mm": [[-900, -900, 0], [900, -900, 0], [900, 900, 0], [-900, 900, 0]], "direction": [0, 0, 1]},
    "facing": {"direction": [0, 0, 1], "within_deg": 1}, "rim_distance_mm": 0.5}
FAR = {
    "box": {"lower_mm": [900, 900, 900], "upper_mm": [901, 901, 901]},
    "half_space": {"point_mm": [0, 0, 900], "normal": [0, 0, 1]},
    "polygon": {"points_mm": [[900, 900, 0], [901, 900, 0], [901, 901, 0]], "direction": [0, 0, 1]},
    "facing": {"direction": [0, 0, 1], "within_deg": 1}, "rim_distance_mm": 0.5}


def numbers(value):
    """Other numbers near this one, the likeliest to be allowed first."""
    if isinstance(value, int):
        return [value + 1, value - 1, value * 2, value + 0.5, value - 0.5]
    return [value * 1.04, value * 0.96, value + 0.25, value - 0.25]


def changes(value, schema):
    """What a value may be changed to, in the order in which it is tried."""
    if "enum" in schema:
        return [name for name in schema["enum"] if name != value]
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, (int, float)):
        return numbers(value)
    if isinstance(value, list) and value:
        found = []
        for i, item in list(enumerate(value))[::-1]:
            found += [value[:i] + [other] + value[i + 1:] for other in changes(item, schema.get("items", {}))]
        return found
    if isinstance(value, list):
        return []
    return [f"{value}_2", f"{value} ; 2", f"copy_of_{value}"]


class Keys(InFolder):
    def base(self):
        """Resolved job and cell of the sample, cut down, with a body of every shape, springs, weights, texts."""
        self.assertEqual(plan(self.folder / "sample").returncode, 0)
        job, cell = (resolved_yaml.parse((self.folder / "sample" / name).read_text()) for name in ("job.yaml", "cell.yaml"))
        for mesh in ("support_pad", "cabin_ring"):
            source = TOP / "toolpaths" / mesh / f"{mesh}.stl"
            for name in (f"{mesh}.stl", f"copy_of_{mesh}.stl"):
                shutil.copy(source, self.folder / name)
        job["cell"] = "cell.yaml"
        for key in ("cutting", "stock", "force_uncertainty_percent", "force_direction_deg"):
            job["process"].pop(key)
        job["path"].pop("over_missing")
        job["pose"]["objective"] = {"name": "chen2021", "w1": 0.5, "w2": 0.5}
        shapes = ({"sphere": {"diameter_mm": 9}}, {"capsule": {"diameter_mm": 9, "length_mm": 60}},
                  {"cone": {"diameter_mm": 9, "top_diameter_mm": 1, "length_mm": 6}},
                  {"convex": {"points_mm": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.1]]}},
                  {"mesh": {"file": "support_pad.stl", "unit": "mm"}})
        for i, shape in enumerate(shapes):
            cell["bodies"].append({"name": f"far{i}", "class": "fixture", "mount": "world", "shape": shape,
                                   "pose": {"xyz_mm": [-3000, 500 * i, 100.5], "abc_deg": [0, 0, 0]}})
        cell["excluded_pairs"] = [["far0", "far1"]]
        springs = {"mount": "base", "pose": {"xyz_mm": [0, 0, 1], "abc_deg": [0, 0, 0]}}
        cell["stiffness"]["compliances"] = [
            {"name": "platform", "translational_mm_N": [1.0e-4, 2.0e-4, 5.0e-5], "rotational_rad_Nm": [1e-9, 1e-9, 1e-9],
             **springs}]
        return job, cell

    def write(self, job, cell):
        (self.folder / "job.yaml").write_text(json.dumps(job))
        (self.folder / "cell.yaml").write_text(json.dumps(cell))

    def plan(self, out, *arguments):
        return run("plan", self.folder / "job.yaml", "-o", self.folder / out, "-q", *arguments)

    def check(self, key):
        """Plans the changed job over the base's checkpoints and afresh; what was refused, if it was."""
        shutil.rmtree(self.folder / "again", ignore_errors=True)
        shutil.copytree(self.folder / "base", self.folder / "again")
        again = self.plan("again")
        if again.returncode == 2:
            return again.stderr
        self.assertLess(again.returncode, 2, f"{key}: {again.stderr}")
        figures = json.loads((self.folder / "again" / "run.json").read_text())
        self.resumed[key] = (figures["resumed_passes"], figures["resumed_gaps"])
        shutil.rmtree(self.folder / "fresh", ignore_errors=True)
        self.assertLess(self.plan("fresh", "--fresh").returncode, 2)
        again, fresh = tree(self.folder / "again"), tree(self.folder / "fresh")
        with self.subTest(key=key):
            self.assertEqual([name for name in again.keys() | fresh.keys() if again.get(name) != fresh.get(name)], [])
        return None

    def change_each(self, job, cell, wanted):
        """Changes each of the wanted keys that job and cell hold; those that could be changed."""
        self.write(job, cell)
        shutil.rmtree(self.folder / "base", ignore_errors=True)
        planned = self.plan("base")
        self.assertLess(planned.returncode, 2, planned.stderr)
        changed, refusals = set(), {}
        for name in ("job", "cell"):
            schema = json.loads((TOP / "docs" / "schema" / f"{name}.schema.json").read_text())
            document = {"job": job, "cell": cell}[name]
            for key, container, inner_key, inner in resolved_yaml.places(schema, document):
                if key in changed or key not in wanted:
                    continue
                before = copy.deepcopy(container[inner_key])
                for other in [OTHER_NAMES[key]] if key in OTHER_NAMES else changes(before, inner):
                    container[inner_key] = other
                    self.write(job, cell)
                    refused = self.check(key)
                    container[inner_key] = before
                    if refused is None:
                        changed.add(key)
                        break
                    refusals[key] = refused
        self.refusals.update({key: text for key, text in refusals.items() if key not in changed})
        return changed

    def variants(self):
        """(job, cell) by (job, cell): together they hold every key."""
        job, cell = self.base()
        job["pose"]["objective"] = {"name": "process_force"}
        job["process"].update(feed="reduce", min_feed_share=0.5, plunge_feed_mm_min=60, approach_feed_mm_min=900)
        job["process"]["cutting"] = {"teeth": 2, "depth_mm": 1, "width_mm": 6, "side": "slot", "material": "5A06",
                                     "radial_ratio": 0.3, "axial_ratio": 0.1}
        yield job, cell
        if not ALL:
            return
        job, cell = self.base()
        job["toolpath"]["region"] = {**copy.deepcopy(WIDE), "all": [copy.deepcopy(WIDE)], "any": [copy.deepcopy(WIDE)],
                                     "none": [copy.deepcopy(FAR)]}
        cell["arm"]["lengths_mm"]["dy"] = 2.5
        job["toolpath"]["ends"] = {"overrun_mm": 1, "lead": "ramp", "lead_length_mm": 10, "ramp_deg": 15}
        job["toolpath"]["depth"] = {"total_mm": 1, "per_layer_mm": 0.5, "allowance_mm": 0.1, "finishing_mm": 0.2}
        job["process"].update(cutting={"teeth": 2, "kc11_N_mm2": 700, "mc": 0.2, "kc11_source": "a cut", "side": "up"}, stock="region",
                              force_uncertainty_percent=30, force_direction_deg=20)
        job["pose"]["objective"] = {"name": "surface_error", "direction": "normal"}
        job["process"]["force_factors"] = {"up": 1.1, "down": 0.9, "slot": 1.2}
        job["compensation"] = {"deflection": "normal", "shrink": 0.5, "stiffness_uncertainty_percent": 12, "max_mm": 0.05,
                               "layers": "all", "weight": False}
        cell["arm"]["absolute_accuracy"] = True
        job["path"].update(criterion="worst_then_sum", lift_gain_percent=50, max_lifts=1, max_joint_step_deg=[30, 30, 30, 30, 30, 30])
        job["program_options"]["point_economy"] = {"chord_mm": 0.01, "angle_deg": 0.01}
        cell["tool"].update(tip_uncertainty_mm=0.2, axis_uncertainty_deg=0.05, load={
            "mass_kg": 60.5, "centre_in_flange_mm": [0, 0, 150.5], "inertia_kg_m2": [1.5, 1.5, 0.5]})
        for region in (job["toolpath"]["region"], *(job["toolpath"]["region"][name][0] for name in ("all", "any", "none"))):
            region["connected"] = {"seed_mm": [0, 0, 0], "crease_deg": 60}
        yield job, cell

        job, cell = self.base()
        job["process"]["cutting"] = {"teeth": 2, "depth_mm": 1, "material": "5A06"}
        job["path"]["over_missing"] = "leave_out"
        job["compensation"] = {"deflection": "normal", "deviations": True}
        cell["arm"].update(gear_error={"amplitude_arcsec": [9.5] * 6, "periods_per_turn": [200.5] * 6, "source": "assumed"},
                           gear_couplings=[{"gear": 3, "axis": 2, "factor": 0.5}])
        cell["arm"]["stiffness_uncertainty_percent"] = [5, 5, 5, 5, 5, 5]
        cell["arm"].update(serial="882134", deviations={
            "shifts_mm": [[0.1 * i, -0.05 * i, 0.2] for i in range(7)], "turns_mrad": [[0.1, 0.05 * i, -0.1] for i in range(7)],
            "uncertainty_mm": 0.1, "source": "drawn", "date": "2026-01-02"})
        yield job, cell

        job, cell = self.base()
        job["compensation"] = {"deflection": "off", "deviations": True, "max_gear_mm": 1.5}
        cell["arm"].update(serial="882134", deviations={
            "shifts_mm": [[0.1, 0, 0]] * 7, "turns_mrad": [[0, 0.1, 0]] * 7, "source": "drawn", "date": "2026-01-02",
            "gears": [{"joint": 2, "harmonic": 1, "amplitude_arcsec": 9.5, "phase_deg": 30.5}],
            "couplings": [{"joint": 3, "follows": 2, "factor": 0.0001}],
            "patterns": [{"shifts_mm": [[0.01, 0.02, 0.03]] * 7, "turns_mrad": [[0.01, 0.02, 0.03]] * 7, "factors": [0.00001]}]})
        yield job, cell

        job, cell = self.base()
        self.write(job, cell)
        self.assertLess(self.plan("forceless").returncode, 2)
        with (self.folder / "forceless" / "points.csv").open(encoding="utf-8") as file:
            points = [row.split(",") for row in file.read().splitlines()[1:]]
        forces = ["point,x_mm,y_mm,z_mm,force_x_N,force_y_N,force_z_N"]
        forces += [",".join([row[0], *row[6:9], "30", "-20", "90"]) for row in points]
        for name in ("forces.csv", "copy_of_forces.csv"):
            (self.folder / name).write_text("\n".join(forces) + "\n")
        job["process"]["force_csv"] = "forces.csv"
        job["compensation"] = {"deflection": "normal"}
        yield job, cell

        job, cell = self.base()
        place = job["workpiece"].pop("pose")["xyz_mm"]
        # Turned by B = -90 degrees: x of the part is z of the robot base, z is -x.
        job["workpiece"]["targets"] = [
            {"nominal_mm": [x, y, 0], "measured_mm": [place[0], place[1] + y, place[2] + x]}
            for x, y in ((0, 0), (100, 0), (0, 100), (100, 110.5))]
        job["workpiece"]["allowance_mm"] = 0.1
        job["program_options"]["date"] = "2026-01-02"
        cell["stiffness"]["compliances"] = [
            {"name": "platform", "mount": "base", "pose": {"xyz_mm": [0, 0, 1], "abc_deg": [0, 0, 0]},
             "matrix": [[1e-4 if i == j < 3 else 1e-9 if i == j else 0 for i in range(6)] for j in range(6)]}]
        cell["stiffness"]["gravity"] = {
            "reference_deg": [0, -90, 90, 0, 0, 0], "counterbalance": {"torque_Nm": 100, "zero_deg": -90},
            "masses": [{"name": "spindle", "mount": "link6", "mass_kg": 30, "centre_mm": [0, 0, 100.5]}]}
        job["compensation"] = {"deflection": "off", "weight": True, "deviations": True, "max_deviation_mm": 6}
        cell["arm"].update(serial="882134", gear_friction_Nm=[20.5] * 6, deviations={
            "shifts_mm": [[0.1, 0, 0]] * 7, "turns_mrad": [[0, 0, 0]] * 7, "source": "drawn", "date": "2026-01-02"})
        krl = cell["controllers"]["krl"]
        krl["texts"] = {name: f"; {name}" for name in TEXTS}
        krl["outputs"] = [{"number": 3, "at": "cut_begin", "set": True, "delay_ms": -20}]
        krl.update(orientation_acceleration_deg_s2=500, path_acceleration_m_s2=2)
        krl.update(external_axes=[{"name": "E1", "constant_mm": 500.5, "coupled": True}, {"name": "E2", "constant_deg": 10.5}],
                   ersysroot={"pose": {"xyz_mm": [0, -200, 300], "abc_deg": [0, 0, 0]}, "direction": "y"})
        cell["controllers"]["linuxcnc"]["texts"] = {"header": "; header"}
        cell["controllers"]["sinumerik"]["texts"] = {"header": "; header"}
        yield job, cell

        job, cell = self.base()
        job["workpiece"]["stock"] = {"mesh": "support_pad.stl", "unit": "mm"}
        job["process"].update(cutting={"teeth": 2, "depth_mm": 1, "kc11_N_mm2": 700, "mc": 0.2},
                              stock="region")
        job["process"].pop("min_feed_share", None)
        job["process"]["feed"] = "keep"
        self.strategy(job, "pad", {"pattern": "zigzag", "along": [1, 0, 0], "offset_mm": 20})
        yield job, cell

        job, cell = self.base()
        job["workpiece"]["fixtures"] = [{"name": "clamp", "mount": "workpiece", "shape": {"box": {"size_mm": [20.5, 20, 30]}},
                                         "pose": {"xyz_mm": [-80.5, 0, 0], "abc_deg": [0, 0, 10.5]}}]
        yield job, cell

        for raw in ({"box": {"lower_mm": [-60.5, -60, -5], "upper_mm": [60.5, 60, 3]}, "resolution_mm": 2.5},
                    {"cylinder": {"centre_mm": [0.5, 0, -5], "axis": [0, 0.01, 1], "radius_mm": 90.5, "length_mm": 8}, "resolution_mm": 2.5}):
            job, cell = self.base()
            job["workpiece"]["stock"] = raw
            yield job, cell

        (self.folder / "path.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n-50,0,0,0,0,1\n50,0,0,0,0,1\n")
        shutil.copy(self.folder / "path.csv", self.folder / "copy_of_path.csv")
        lines = "".join(f"0\nLINE\n8\n{layer}\n10\n-50\n20\n{y}\n30\n0\n11\n50\n21\n{y}\n31\n0\n" for layer, y in (("cut", 0), ("cut_2", 20)))
        for name in ("lines.dxf", "copy_of_lines.dxf"):
            (self.folder / name).write_text(f"0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n")
        for name, keys in (("curve", {"points_mm": [[-50, 0, 0], [50, 0, 0]], "project_along": [0, 0, -1]}),
                           ("curve", {"dxf": {"file": "lines.dxf", "unit": "mm", "layers": ["cut"]}, "project_along": [0, 0, -1]}),
                           ("cam", {"file": "path.csv", "contact_distance_mm": 0.2})):
            job, cell = self.base()
            self.strategy(job, name, keys)
            yield job, cell

        job, cell = self.base()
        lean = {"from": -4.5, "to": 4.5, "step": 4.5, "nominal": 0.5}
        job["toolpath"].update(lead_deg=lean, tilt_deg=copy.deepcopy(lean), min_cutting_speed_share=0.2)
        job["path"]["max_lean_change_deg_per_mm"] = 0.1
        cell["tool"]["cutter"]["shape"] = "ball"
        yield job, cell

        job, cell = self.base()
        tool = cell.pop("tool")
        collet = {"name": "collet", "mount": "link6", "translational_mm_N": [1e-4, 1e-4, 1e-4]}
        other = {**copy.deepcopy(tool), "name": "other", "number": 8}
        cell["tools"] = [{**tool, "name": "mill", "number": 7, "compliances": [collet]}, other]
        cell["tool_change_deg"] = [60, -90, 90, 0, 30, 0]
        cell["controllers"]["linuxcnc"]["m6_moves"] = False
        cell["controllers"]["krl"]["tool_in_spindle"] = "TOOL_IN"
        job["tool"] = "mill"
        yield job, cell

        for external in ([{"axis": "rail", "scope": "constant", "at_mm": 20.5}, {"axis": "turn", "scope": "constant", "at_deg": 2.5}],
                         [{"axis": "rail", "scope": "constant", "step_mm": 300}, {"axis": "turn", "scope": "per_pass", "step_deg": 20}]):
            job, cell = self.base()
            job.update(external=external, programs=[])
            cell["external_axes"] = [
                {"name": "rail", "kind": "linear", "carries": "robot", "axis": [0, 1, 0.1], "limits_mm": [-50, 250], "home_mm": 0.5,
                 "speed_mm_s": 500, "acceleration_mm_s2": 400, "stiffness_N_mm": 1e5, "stiffness_source": "assumed",
                 "lost_motion_um": 20.5, "lost_motion_source": "assumed"},
                {"name": "turn", "kind": "rotary", "carries": "workpiece", "axis": [0, 0.1, 1], "origin_mm": [2000, 0, 0], "limits_deg": [-20, 20],
                 "home_deg": 0.5, "speed_deg_s": 20, "acceleration_deg_s2": 20, "stiffness_Nm_per_rad": 1e7, "stiffness_source": "assumed",
                 "lost_motion_arcmin": 0.5, "lost_motion_source": "assumed"}]
            cell["bodies"].append({"name": "carriage", "class": "fixture", "mount": "carriage", "axis": "rail", "shape": {"sphere": {"diameter_mm": 9}},
                                   "pose": {"xyz_mm": [-3000, 3000, 0], "abc_deg": [0, 0, 0]}})
            yield job, cell

        axes = ({"rule": "fixed", "direction": [0, 0.1, 1]}, {"rule": "away", "point_mm": [0, 0, -900]})
        for axis in axes:
            job, cell = self.base()
            job["toolpath"]["tool_axis"] = axis
            job["toolpath"]["share"] = {"direction": [0, 1, 0.1], "from_mm": -25, "to_mm": 25, "overlap_mm": 2}
            yield job, cell

        holes = [{"at_mm": [0, 0, 0], "axis": [0, 0, 1], "depth_mm": 7}, {"at_mm": [20, 0, 0], "axis": [0, 0.1, 1]}]
        for drill in ({"holes": holes, "depth_mm": 6, "point_deg": 118, "clearance_mm": 2, "peck_mm": 3, "chip_retract_mm": 0.5, "dwell_s": 0.5},
                      {"holes": holes[1:], "point_deg": 90, "countersink": {"diameter_mm": 12}},
                      {"holes": holes[1:], "countersink": {"depth_mm": 4}},
                      {"circles": {"diameter_mm": 900, "tolerance_mm": 0.06, "from": [0, 0, 1]}, "breakthrough_mm": 1}):
            job, cell = self.base()
            self.strategy(job, "drill", drill)
            job["pose"]["objective"] = {"name": "drilling"}
            job["toolpath"]["order"] = "laid"
            if "circles" in drill:
                job["workpiece"].update(mesh="cabin_ring.stl", pose={"xyz_mm": [2000, 0, 1150], "abc_deg": [0, -90, 0]})
            yield job, cell

        pad = {"facing": {"direction": [0, 0, 1], "within_deg": 1}}
        square = [[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30.5, 0]]
        ways = {"milling": "climb", "through_mm": 4, "overcut_mm": 1, "per_depth_mm": 6, "allowance_mm": 0, "lead_radius_mm": 8,
                "entry": "helix", "ramp_deg": 10}
        for trim in ({"border": {"near_mm": [0, -40, 0]}, "overlap_mm": 2, "start_mm": [0, -40, 0], **ways,
                      "tabs": {"count": 2, "width_mm": 4, "height_mm": 1}},
                     {"border": {"near_mm": [0, -40, 0], "between_mm": [[-30, -40, 0], [30, -40, 0]]}, **ways},
                     {"line": {"points_mm": square, "closed": False, "side": "right", "blank": True}, **ways},
                     {"line": {"points_mm": square, "closed": True, "side": "outside", "blank": True}, "overlap_mm": 2, **ways,
                      "tabs": {"at_mm": [[0, 30, 0]], "width_mm": 4, "height_mm": 1}}):
            job, cell = self.base()
            self.strategy(job, "trim", trim)
            cell["tool"]["cutter"].update(max_ramp_deg=60, centre_cutting=True)
            job["toolpath"]["region"] = pad
            yield job, cell

        job, cell = self.base()
        self.strategy(job, "rough", {"allowance_mm": 0.5, "per_layer_mm": 4, "max_engagement_deg": 80, "milling": "climb", "ramp_deg": 2, "thicker_than_mm": 0.5,
                                     "bottom_mm": 0.5})
        job["toolpath"]["tool_axis"] = {"rule": "fixed", "direction": [0, 0, 1]}
        job["workpiece"]["stock"] = {"box": {"lower_mm": [-40, -40, -40], "upper_mm": [40, 40, 3]}, "resolution_mm": 1}
        cell["air_feed"] = {"feed_mm_min": 400, "margin_mm": 5.5, "longer_than_mm": 20.5}
        yield job, cell

        corners = ((-40, -40), (40, -40), (40, 40), (-40, 40))
        (self.folder / "sheet.off").write_text(
            "OFF\n4 2 0\n" + "".join(f"{x} {y} 0\n" for x, y in corners) + "3 0 1 2\n3 0 2 3\n")
        job, cell = self.base()
        job["workpiece"].update(mesh="sheet.off", flip=False)
        job["toolpath"].pop("region")
        yield job, cell

        job, cell = self.base()
        job["workpiece"].update(mesh="cabin_ring.stl", pose={"xyz_mm": [2000, 0, 1150], "abc_deg": [0, -90, 0]})
        self.strategy(job, "rings", {"point_mm": [0, 0, 0], "axis": [0, 0, 1], "on": "auto", "path": "closed",
                                     "start_deg": 10, "seam_step_deg": 0})
        job["toolpath"].update(spacing_mm=150, chord_tolerance_mm=20)
        job["toolpath"]["gouges"]["tolerance_mm"] = 20  # the chords count
        yield job, cell

        job, cell = self.base()
        modes = {mode: 0.01 for mode in ("u2", "uv", "v2", "u3", "u2v", "uv2")}
        rows = [[1e-4 if i == j else 0 for j in range(i + 1)] for i in range(6 + len(modes))]
        job["workpiece"]["registration"] = {"max_bending_mm": 5}
        job["workpiece"]["registered"] = {
            "pose": copy.deepcopy(job["workpiece"]["pose"]), "centre_mm": [0, 0, 0], "covariance_mm_mrad": sum(rows[:6], []),
            "bending": {"origin_mm": [0.5, 0.5, -20.5], "u_mm": [40.5, 0, 0], "v_mm": [0, 40.5, 0], "modes_mm": modes,
                        "covariance_mm_mrad": sum(rows[6:], [])}}
        yield job, cell

    @staticmethod
    def strategy(job, name, keys):
        """Takes another strategy, without what belongs to the sample's alone."""
        toolpath = job["toolpath"]
        toolpath.pop("planes")
        toolpath.update({"strategy": name, name: keys})
        if name in ("curve", "cam"):
            for key in ("stepover_mm", "stepover_on", "scallop_mm", "order", "direction", "region"):
                toolpath.pop(key, None)
        if name == "rough":
            for key in ("region", "stepover_mm", "stepover_on", "scallop_mm", "direction", "order", "crease_deg", "normal_smoothing_mm", "depth",
                        "ends", "lead_deg", "tilt_deg"):
                toolpath.pop(key, None)
        if name in ("drill", "trim"):
            if name == "trim":
                toolpath.pop("order", None)
            for key in ("stepover_mm", "stepover_on", "scallop_mm", "direction", "normal_smoothing_mm", "depth", "ends",
                        "tool_axis", "lead_deg", "tilt_deg", *(() if "circles" in keys else ("region", "crease_deg"))):
                toolpath.pop(key, None)
            if "circles" in keys:
                toolpath.pop("region", None)


class All(Keys):
    def test_a_plan_over_earlier_checkpoints_is_that_of_fresh(self):
        wanted, changed = set(), set()
        for name in ("job", "cell"):
            schema = json.loads((TOP / "docs" / "schema" / f"{name}.schema.json").read_text())
            wanted |= set(resolved_yaml.leaves(schema))
        # An operation is a job of its own, and a setup has keys of its workpiece; of several tools the keys are those of `tool`.
        # A tool's compliances are read by the table of `stiffness.compliances`; one key of them shows that they count.
        # A fixture's shape is read by the table of `bodies[].shape`.
        # What `placement` says is for `millpose place` (place_test.py).
        twice = ("placement.", "workpiece.fixtures[].shape", "operations[]", "setups[]", "tools[].tip", "tools[].axis", "tools[].x_", "tools[].cutter", "tools[].stack", "tools[].load",
                 "tool.number", "tool.compliances[]", "tools[].compliances[].matrix", "tools[].compliances[].mount",
                 "tools[].compliances[].pose", "tools[].compliances[].rotational")
        wanted = {key for key in wanted if not key.startswith(twice)} - LEFT_OUT.keys() if ALL else FEW_KEYS
        self.resumed, self.refusals = {}, {}
        for job, cell in self.variants():
            changed |= self.change_each(job, cell, wanted - changed)
        # A controller refuses keys that it does not know; no stage with checkpoints is handed any of them.
        controllers = {key for key in changed if key.startswith("controllers.")}
        self.assertGreater(len(controllers), 30 if ALL else 0)
        missing = sorted(key for key in wanted - changed if not key.startswith("controllers."))
        self.assertEqual(missing, [], "not changed: " + "\n".join(f"{key}: {self.refusals.get(key, 'absent')}" for key in missing))
        self.assertEqual(self.resumed["process.spindle_rpm"][0], 0, "the force depends on it")
        self.assertGreater(self.resumed["controllers.krl.advance"][0], 0, "no stage is handed it")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

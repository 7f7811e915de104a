#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads robots of other projects, plans for them, and checks the paths: the table in docs/arms.md.

survey_robots.py FOLDER TRELLIS [NAME...]    FOLDER has a checkout of each project under its own name

For each robot: CPU time of reading it with no stored covers, and again; four boxes in its reach; two configurations
with which the robot touches nothing, drawn by robot:valid; rrt_connect between them with two seeds; and
check_arm_path.py, which shares no code with Trellis, on the paths. Where no seed finds a path, the next pair of
configurations is tried, at most four. Projects have xacro files: `xacro IN OUT` of ROS expands them, to the names
that ROBOTS gives. Prints a table in Markdown, and what Trellis warned of.
"""
import importlib.util
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = "example-robot-data/robots"


def numbered(name, count):
    return [name.format(i) for i in range(1, count + 1)]


UR = [f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")]
KORTEX = "ros_kortex/kortex_move_it_config/gen3_robotiq_2f_{0}_move_it_config/config/7dof/gen3_robotiq_2f_{0}.srdf"
ICUB = [f"r_{name}" for name in ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_prosup",
                                 "wrist_pitch", "wrist_yaw")]
# Name: URDF file, SRDF file, group, values of joints at which links touch that do not move.
ROBOTS = {
    "panda": ("moveit_resources/panda_description/urdf/panda.urdf",
              "moveit_resources/panda_moveit_config/config/panda.srdf", "panda_arm", ""),
    "fr3": ("franka_ros/franka_description/robots/fr3/fr3.urdf", None, numbered("fr3_joint{}", 7),
            "fr3_finger_joint1 = 0.02"),
    "fanuc_m10ia": ("moveit_resources/fanuc_description/urdf/fanuc.urdf",
                    "moveit_resources/fanuc_moveit_config/config/fanuc.srdf", "manipulator", ""),
    "pr2": ("moveit_resources/pr2_description/urdf/robot.xml", "moveit_resources/pr2_description/srdf/robot.xml",
            "right_arm", "r_gripper_l_finger_joint = 0.3, l_gripper_l_finger_joint = 0.3"),
    "prbt": ("pilz_robots/prbt_support/urdf/prbt.urdf", "pilz_robots/prbt_moveit_config/config/prbt.srdf",
             "manipulator", ""),
    "ur5": ("universal_robot/ur_description/urdf/ur5.urdf", "universal_robot/ur5_moveit_config/config/ur5.srdf",
            "manipulator", ""),
    "ur10e": ("universal_robot/ur_description/urdf/ur10e.urdf",
              "universal_robot/ur10e_moveit_config/config/ur10e.srdf", "manipulator", ""),
    "ur5_gripper": (f"{EXAMPLES}/ur_description/urdf/ur5_gripper.urdf",
                    f"{EXAMPLES}/ur_description/srdf/ur5_gripper.srdf", UR, ""),
    "iiwa14": ("iiwa_stack/iiwa_description/urdf/iiwa14.urdf", "iiwa_stack/iiwa_moveit/config/iiwa14.srdf",
               "manipulator", ""),
    "lbr_iiwa7": ("lbr_fri_ros2_stack/lbr_description/urdf/iiwa7/iiwa7.urdf", None, None, ""),
    "gen3_2f85": ("ros_kortex/kortex_description/robots/gen3_robotiq_2f_85.urdf", KORTEX.format(85), "arm", ""),
    "gen3_2f140": ("ros_kortex/kortex_description/robots/gen3_robotiq_2f_140.urdf", KORTEX.format(140), "arm", ""),
    "jaco_j2n6s300": ("kinova-ros/kinova_description/urdf/j2n6s300.urdf",
                      "kinova-ros/kinova_moveit/robot_configs/j2n6s300_moveit_config/config/j2n6s300.srdf", "arm", ""),
    "talos": (f"{EXAMPLES}/talos_data/robots/talos_full_v2.urdf", f"{EXAMPLES}/talos_data/srdf/talos.srdf", "r_arm",
              "arm_left_2_joint = 0.4, leg_left_2_joint = 0.1"),
    "tiago": (f"{EXAMPLES}/tiago_description/robots/tiago.urdf", None,
              ["torso_lift_joint"] + numbered("arm_{}_joint", 7), ""),
    "icub": ("icub-models/iCub/robots/iCubGazeboV2_7/model.urdf", None, ICUB, "l_shoulder_roll = 1.0, l_elbow = 0.8"),
    "spot": ("spot_ros/spot_description/urdf/spot_arm.urdf", None,
             [f"front_{side}_{name}" for side in ("left", "right") for name in ("hip_x", "hip_y", "knee")], ""),
    "anymal_b_kinova": (f"{EXAMPLES}/anymal_b_simple_description/robots/anymal-kinova.urdf",
                        f"{EXAMPLES}/anymal_b_simple_description/srdf/anymal-kinova.srdf", "arm", ""),
    "xarm7_gripper": ("xarm_ros/xarm_description/urdf/xarm7_gripper.urdf",
                      "xarm_ros/xarm7_gripper_moveit_config/config/xarm7_with_gripper.srdf", "xarm7", ""),
    "b1_z1": (f"{EXAMPLES}/b1_description/urdf/b1-z1.urdf", f"{EXAMPLES}/b1_description/srdf/b1-z1.srdf", "arm", ""),
    "baxter": (f"{EXAMPLES}/baxter_description/urdf/baxter.urdf",
               f"{EXAMPLES}/baxter_description/srdf/baxter_manipulation.srdf",
               [f"left_{name}" for name in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")], ""),
    "fetch": ("vamp/resources/fetch/fetch.urdf", "vamp/resources/fetch/fetch.srdf", "arm_with_torso", ""),
    "yumi": ("robot-assets/urdfs/robots/yumi/yumi.urdf", None, [f"yumi_joint_{i}_r" for i in (1, 2, 7, 3, 4, 5, 6)],
             "gripper_r_joint = 0.02, gripper_l_joint = 0.02"),
    "sda10f": ("motoman/motoman_sda10f_support/urdf/sda10f.urdf",
               "motoman/motoman_sda10f_moveit_config/config/motoman_sda10f.srdf", "arm_left", ""),
}


def checker_module():
    spec = importlib.util.spec_from_file_location("check_arm_path", os.path.join(HERE, "check_arm_path.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def quoted(texts):
    return ", ".join(f'"{text}"' for text in texts)


class Survey:
    def __init__(self, folder, trellis, work):
        self.folder, self.trellis, self.work = os.path.abspath(folder), os.path.abspath(trellis), work
        self.checker = checker_module()
        self.checker.Robot.shape = staticmethod(lambda shape, urdf, cache: self.checker.ball([0, 0, 0], 0.01))
        self.environment = {**os.environ, "XDG_CACHE_HOME": os.path.join(work, "cache"), "TRELLIS_NO_CACHE": "0"}

    def call(self, *command, seconds=400):
        """Returns status, output, errors and CPU seconds."""
        before = os.times()
        run = subprocess.run(command, cwd=self.work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             errors="replace", timeout=seconds, env=self.environment, check=False)
        after = os.times()
        cpu = after.children_user + after.children_system - before.children_user - before.children_system
        return run.returncode, run.stdout, run.stderr, cpu

    def write(self, name, text):
        with open(os.path.join(self.work, name), "w", encoding="utf-8") as file:
            file.write(text)

    def robot_text(self, urdf, srdf, group, values):
        options = [f'srdf = "{self.folder}/{srdf}"'] if srdf else []
        if values:
            options.append(f"values = {{ {values} }}")
        if isinstance(group, str):
            options.append(f'group = "{group}"')
        elif group:
            options.append(f"group = {{ {quoted(group)} }}")
        more = f", {{ {', '.join(options)} }}" if options else ""
        return f'local arm = robot.urdf("{self.folder}/{urdf}"{more})\n'

    def boxes(self, urdf, srdf, group, stream):
        """Four boxes where the last links come and the first ones do not, and a length that bounds all of it."""
        np = self.checker.np
        robot = self.checker.Robot(f"{self.folder}/{urdf}", f"{self.folder}/{srdf}" if srdf else None)
        joints = robot.moving(group)
        places = {link: [] for link in robot.links}
        for _ in range(200):
            q = {}
            for name in joints:
                joint = robot.by_name[name]
                bounds = (-math.pi, math.pi) if joint.kind == "continuous" else (joint.lo, joint.hi)
                q[name] = np.array(stream.uniform(max(bounds[0], -math.pi), min(bounds[1], math.pi)))
            for link, pose in robot.poses(q).items():
                places[link].append(np.asarray(pose[1], float).reshape(3))
        places = {link: np.array(all_) for link, all_ in places.items()}
        spread = {link: float(np.linalg.norm(p - p.mean(0), axis=1).max()) for link, p in places.items()}
        most = max(spread.values())
        far = np.array([p for link, all_ in places.items() if spread[link] > 0.5 * most for p in all_])
        near = np.array([p for link, all_ in places.items() if spread[link] <= 0.3 * most for p in all_[:20]])
        middle = np.median(far, 0)
        reach = float(np.percentile(np.linalg.norm(far - middle, axis=1), 90))
        boxes = []
        for _ in range(4):
            for _ in range(200):
                centre = far[stream.randrange(len(far))]
                half = np.array([stream.uniform(0.04, 0.12) * reach for _ in range(3)])
                if (np.maximum(abs(near - centre) - half, 0).max(1) > 0.25 * reach).all():
                    break
            boxes.append([*(centre - half), *(centre + half)])
        return boxes, 3 * reach + float(np.linalg.norm(middle)) + 1

    @staticmethod
    def world_text(boxes, size):
        shapes = "".join(", box { " + ", ".join(f"{x:.5f}" for x in box) + f', name = "box {i}" }}'
                         for i, box in enumerate(boxes, 1))
        bounds = ", ".join(f"{x:.3f}" for x in [-size] * 3 + [size] * 3)
        return f'local room = world {{ bounds = {{{bounds}}}, contain = "none"{shapes} }}\n'

    def free_configurations(self, head):
        """Up to four configurations that robot:valid allows, of at most 120."""
        self.write("pick.lua", head + r"""
local found, tried = 0, 0
while found < 4 and tried < 120 do
  local q, text = {}, {}
  tried = tried + 1
  for i, joint in ipairs(arm:joints()) do
    local lo, hi = math.max(joint.lower or -math.pi, -math.pi), math.min(joint.upper or math.pi, math.pi)
    q[i] = lo + (hi - lo) * math.random()
    text[i] = string.format("%.17g", q[i])
  end
  if arm:valid(q, room) then found = found + 1; print("FOUND " .. table.concat(text, ", ")) end
end
return rrt {}, scenes.trap()
""")
        _, out, _, _ = self.call(self.trellis, "check", "--trust", "pick.lua")
        return re.findall(r"^FOUND (.*)", out, re.M)

    def robot(self, name):
        urdf, srdf, group, values = ROBOTS[name]
        row = {"name": name, "joints": "", "load": ["", ""], "solved": "", "ms": "", "clearance": "", "paths": "",
               "note": "", "warnings": []}
        head = self.robot_text(urdf, srdf, group, values)
        self.write("load.lua", head + 'print("READ " .. #arm.joints)\nreturn rrt {}, scenes.trap()\n')
        shutil.rmtree(self.environment["XDG_CACHE_HOME"], ignore_errors=True)
        for k in range(2):
            status, out, errors, cpu = self.call(self.trellis, "check", "--trust", "load.lua")
            row["load"][k] = f"{cpu:.2f}"
        row["warnings"] = [line.replace(self.folder + "/", "") for line in errors.splitlines() if "warning" in line]
        read = re.search(r"^READ (\d+)", out, re.M)
        if status != 0 or not read:
            row["note"] = "not read"
            return row
        row["joints"] = read.group(1)
        boxes, size = self.boxes(urdf, srdf, group, random.Random(name))
        head += self.world_text(boxes, size)
        found = self.free_configurations(head)
        for number, (start, goal) in enumerate(((0, 1), (2, 3), (0, 2), (1, 3)), 1):
            if max(start, goal) >= len(found):
                continue
            self.write("plan.lua", head + f"""
local task = problem {{ name = "{name}", world = room, robot = arm, start = {{ {found[start]} }}, goal = {{ {found[goal]} }} }}
return experiment {{
  problems = {{ task }}, seeds = 2, measure = false,
  strategies = {{ rrt_connect = rrt_connect {{ step = 1, seconds = 90, proposals = 1000000 }} }}
}}
""")
            status, _, errors, _ = self.call(self.trellis, "run", "--trust", "--jobs", "1", "plan.lua", "--json",
                                             "plan.json")
            if status not in (0, 1):
                row["note"] = errors.strip().splitlines()[-1][:200]
                return row
            with open(os.path.join(self.work, "plan.json"), encoding="utf-8") as file:
                runs = json.load(file)["runs"]
            solved = [run for run in runs if run["solved"]]
            row["solved"] = f"{len(solved)} of {len(runs)}"
            if not solved:
                continue
            if number > 1:
                row["note"] = f"pair {number}"
            row["ms"] = f"{sorted(run['cpu_s'] for run in runs)[len(runs) // 2] * 1000:.1f}"
            row["clearance"] = f"{min(run['clearance'] for run in solved) * 1000:.1f}"
            allowed = []
            for line in row["warnings"]:
                if "not checked against each other" in line:
                    for a, b in re.findall(r"'([^' ]+)' and '([^' ]+)'", line):
                        allowed += ["--allow", f"{a},{b}"]
            status, out, errors, _ = self.call(sys.executable, os.path.join(HERE, "check_arm_path.py"), "plan.lua",
                                               "plan.json", *allowed, seconds=900)
            row["paths"] = {0: "free", 1: "contact"}.get(status, "not read")
            if status != 0:
                row["note"] = (out + errors).strip()[-300:]
            return row
        row["note"] = f"{len(found)} valid configurations of 120" if len(found) < 2 else "no path"
        return row



def main():
    if len(sys.argv) < 3 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    rows = []
    with tempfile.TemporaryDirectory() as work:
        survey = Survey(sys.argv[1], sys.argv[2], work)
        for name in sys.argv[3:] or ROBOTS:
            try:
                rows.append(survey.robot(name))
            except (OSError, ElementTree.ParseError, subprocess.TimeoutExpired) as fault:
                sys.exit(f"{name}: {fault}")
            print(f"{name}: {rows[-1]['solved'] or 'not planned'} {rows[-1]['paths']}", file=sys.stderr, flush=True)
    print("| robot | joints | load, CPU s | again | solved | planning, ms | clearance, mm | checked | note |")
    print("|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        print("| {name} | {joints} | {0} | {1} | {solved} | {ms} | {clearance} | {paths} | {note} |".format(
            *row["load"], **{key: value for key, value in row.items() if key not in ("load", "warnings")}))
    planned = sum(row["paths"] != "" for row in rows)
    print(f"\n{len(rows)} robots, {planned} planned for, paths of {sum(row['paths'] == 'free' for row in rows)} free\n")
    for row in rows:
        print(f"- {row['name']}: {ROBOTS[row['name']][0]}")
        for line in row["warnings"]:
            print(f"  - {line[:400]}")


if __name__ == "__main__":
    main()

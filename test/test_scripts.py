# SPDX-License-Identifier: BSD-3-Clause
"""The shell scripts, and the rules that hold for every file of the repository."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ("include", "src", "test", "scripts", "examples", "python", "cmake", "debian", ".ci")
CODE = {".hpp", ".cpp", ".py", ".sh", ".in", ".html", ".css", ".js"}
# The folders of include/ and src/, lowest first: each includes only those before it.
LAYERS = ("core", "config", "calibration", "blur", "frame", "pose", "tracking", "segmentation", "robot", "graph", "map",
          "mesh", "grid",
          "loop", "slam", "io", "evaluation", "run", "python", "simulator", "bags", "ros", "openni2",
          "nodelets", "tools", "viewer")
FORMATTER = "version 14."  # of clang-format: other versions format some lines differently


def files(*folders):
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path


def code_files():
    for path in files(*SOURCES):
        if path.suffix in CODE or (path.suffix == "" and path.read_bytes()[:2] == b"#!"):
            yield path


def shell_scripts():
    for path in files("scripts", ".ci"):
        if path.suffix == ".sh" or path.read_bytes().startswith(b"#!/usr/bin/env bash"):
            yield path


def name(path):
    return str(path.relative_to(ROOT))


def folder_of(parts):
    """The folder of a source, or of an include: posefusion/map/render.hpp is in map, posefusion_ros/bags/messages.hpp
    in bags."""
    if parts[0] == "posefusion_ros" and len(parts) > 2:
        return parts[1]
    library = {"posefusion_ros": "ros", "posefusion_openni2": "openni2"}
    return library.get(parts[0]) or (parts[1] if parts[0] == "posefusion" else parts[0])


def documents():
    return sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


def known_settings():
    """group.name of each setting, read from the restated defaults."""
    known, group = set(), ""
    for line in (ROOT / "config" / "posefusion.yaml").read_text().splitlines():
        found = re.match(r"( *)(\w+):", line)
        if found and not found.group(1):
            group = found.group(2)
        elif found:
            known.add(f"{group}.{found.group(2)}")
    return known


class Scripts(unittest.TestCase):
    def test_shell_scripts_parse(self):
        scripts = list(shell_scripts())
        self.assertGreater(len(scripts), 5)
        for script in scripts:
            done = subprocess.run(["bash", "-n", str(script)], stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_scripts_can_be_executed(self):
        for path in files("scripts", ".ci"):
            if path.suffix == "":
                self.assertTrue(os.access(path, os.X_OK), name(path))

    def test_setup_lists_its_packages(self):
        done = subprocess.run([str(ROOT / "scripts" / "setup"), "--list"], cwd="/", text=True,
                              stdout=subprocess.PIPE)
        self.assertEqual(done.returncode, 0)
        packages = done.stdout.split()
        self.assertEqual(len(packages), len(set(packages)))
        documented = (ROOT / "docs" / "dependencies.md").read_text()
        for package in packages:
            self.assertIn(f"`{package}`", documented, "docs/dependencies.md must state its purpose")

    def test_setup_asks_rosdep_on_ubuntu(self):
        if shutil.which("rosdep", path="/usr/bin"):
            self.skipTest("skipped: there is a real rosdep")
        with tempfile.TemporaryDirectory() as folder:
            release, rosdep, log = (pathlib.Path(folder, name) for name in ("release", "rosdep", "log"))
            release.write_text("ID=ubuntu\nVERSION_ID=20.04\n")
            environment = {**os.environ, "POSEFUSION_OS_RELEASE": str(release), "ROS_DISTRO": "noetic",
                           "PATH": f"{folder}:{os.environ['PATH']}"}
            setup = [str(ROOT / "scripts" / "setup")]
            done = subprocess.run(setup, env=environment, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("found no rosdep: install python3-rosdep", done.stderr)
            rosdep.write_text(f'#!/bin/sh\necho "$@" >> {log}\n[ "$1" = install ]\n')
            rosdep.chmod(0o755)
            done = subprocess.run(setup, env=environment, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            what = f"--from-paths {ROOT} --ignore-src --rosdistro noetic"
            self.assertEqual(log.read_text(), f"check {what}\ninstall {what} -y\n")

    def test_only_known_systems_are_tested_in(self):
        done = subprocess.run([str(ROOT / "scripts" / "test_in"), "sarge"], stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("'sarge': expected bullseye, bookworm or trixie", done.stderr)

    def test_summary_counts_and_reports_failure(self):
        with tempfile.TemporaryDirectory() as folder:
            results = pathlib.Path(folder)
            (results / "gtest-a.xml").write_text(
                '<testsuites><testsuite><testcase classname="A" name="one"/>'
                '<testcase classname="A" name="two"><skipped message="x&#10;skipped: no test data at'
                ' here&#10;"/></testcase></testsuite></testsuites>')
            log = results / "log"
            log.write_text("100% tests passed, 0 tests failed out of 1\n")
            summary = [str(ROOT / "scripts" / "test_summary"), folder, str(log)]
            done = subprocess.run(summary, stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0)
            self.assertIn("1 case skipped: no test data at here", done.stdout)
            self.assertIn("tests: 1 programs, 0 failed; cases: 1 run, 0 failed, 1 skipped",
                          done.stdout)
            (results / "gtest-b.xml").write_text("<testsuites><testsuite>")
            done = subprocess.run(summary, stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 1, "a report cut short is a failed test")


class Repository(unittest.TestCase):
    def test_core_includes_no_ros(self):
        outside = ("src/nodelets/", "src/bags/", "src/ros/", "src/openni2/", "src/tools/", "src/viewer/",
                   "include/posefusion_ros/")
        ros = re.compile(r'#include\s*[<"](ros|nodelet|pluginlib|tf2_ros|tf2_eigen|cv_bridge|\w+_msgs|'
                         r'message_filters|image_transport|std_srvs|dynamic_reconfigure|'
                         r'diagnostic_updater|camera_info_manager)/')
        # A bag is a file format: read by ROS's own library in one place, without a master.
        bag_reader = re.compile(r"src/io/bag\w*\.(cpp|hpp)$|include/posefusion/io/bag\w*\.hpp$")
        looked_at = 0
        for path in files("include", "src"):
            if name(path).startswith(outside) or bag_reader.search(name(path)):
                continue
            if path.suffix not in (".hpp", ".cpp"):
                continue
            looked_at += 1
            for line in path.read_text().splitlines():
                self.assertIsNone(ros.search(line), f"{name(path)}: {line}")
        self.assertGreater(looked_at, 20)

    def test_no_folder_depends_on_one_above_it(self):
        includes = 0
        for path in files("include", "src"):
            if path.suffix not in (".hpp", ".cpp"):
                continue
            here = folder_of(path.relative_to(ROOT).parts[1:])
            self.assertIn(here, LAYERS, f"{name(path)}: a new folder needs a place in LAYERS")
            for included in re.findall(r'#include "([^"]+/[^"]+)"', path.read_text()):
                there = folder_of(included.split("/"))
                if there not in LAYERS:
                    continue
                includes += 1
                self.assertLessEqual(LAYERS.index(there), LAYERS.index(here),
                                     f"{name(path)} includes {included}")
        self.assertGreater(includes, 200)

    def test_sources_are_formatted(self):
        try:
            version = subprocess.run(["clang-format", "--version"], stdout=subprocess.PIPE, text=True)
        except FileNotFoundError:
            self.skipTest("no clang-format")
        if FORMATTER not in version.stdout:
            self.skipTest(f"clang-format is not {FORMATTER}: {version.stdout.strip()}")
        sources = [str(p) for p in files("include", "src", "test", "examples") if p.suffix in (".hpp", ".cpp")]
        done = subprocess.run(["clang-format", "--dry-run", "-Werror", *sources], cwd=ROOT, text=True,
                              stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 0, "run clang-format -i:\n" + done.stderr[:2000])

    def test_catkin_lint_has_nothing_to_say(self):
        if not shutil.which("catkin_lint"):
            self.skipTest("no catkin_lint")
        done = subprocess.run(["catkin_lint", "--strict", "-q", str(ROOT)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_debian_packages_have_the_version_and_the_dependencies_of_the_rest(self):
        version = re.search(r"<version>(.*)</version>", (ROOT / "package.xml").read_text()).group(1)
        self.assertTrue((ROOT / "debian" / "changelog").read_text().startswith(f"posefusion ({version}) "))
        control = (ROOT / "debian" / "control").read_text()
        source, *packages = [set(re.findall(r"^ ([a-z0-9][a-z0-9.+-]+)(?: \(.*\))?,$", part, re.MULTILINE))
                             for part in control.split("\n\n")]
        setup = set(subprocess.run([str(ROOT / "scripts" / "setup"), "--list"], text=True,
                                   stdout=subprocess.PIPE).stdout.split())
        self.assertEqual(source - setup, {"debhelper-compat", "dh-python"})
        tests_only = {"libgtest-dev", "librostest-dev", "libpcl-dev"}
        self.assertEqual({p for p in setup if p.endswith("-dev")} - source, tests_only)
        for package in packages:
            self.assertEqual(package - setup - {"posefusion", "rospack-tools"}, set())

    def test_every_source_names_its_licence(self):
        for path in code_files():
            head = "\n".join(path.read_text().splitlines()[:3])
            self.assertIn("SPDX-License-Identifier: BSD-3-Clause", head, name(path))

    def test_documents_name_what_exists(self):
        """Links, scripts, programs, launch files and settings that the documents speak of."""
        settings = known_settings()
        groups = "|".join(sorted({s.split(".")[0] for s in settings}))
        programs = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
        found = 0
        for path in documents():
            text = path.read_text()
            named = [path.parent / link for link in
                     re.findall(r"\]\((?!https?:|#)([^)#]+)(?:#[^)]*)?\)", text)]
            named += [ROOT / script for script in re.findall(r"(?<![\w/-])scripts/\w+(?:\.\w+)?", text)]
            named += [programs / p for p in re.findall(r"devel/lib/posefusion/(\w+)", text)]
            named += [ROOT / "launch" / f
                      for f in re.findall(r"roslaunch posefusion (\w+\.launch)", text)]
            for thing in named:
                self.assertTrue(thing.exists(), f"{name(path)}: {thing} does not exist")
            for setting in re.findall(rf"(?:`|--set )((?:{groups})\.(?!ply|png|pfdb|partial|yaml|launch)\w+)", text):
                self.assertIn(setting, settings, name(path))
                found += 1
            found += len(named)
        self.assertGreater(found, 30)

    def test_lines_of_documents_are_short(self):
        """Tables and commands cannot be broken."""
        for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]:
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if not line.startswith(("|", "    ")):
                    self.assertLessEqual(len(line), 160, f"{path.name}:{number}")

    def test_every_setting_is_used(self):
        """A setting that is only listed would have no effect."""
        code = "".join(path.read_text() for path in files("include", "src")
                       if path.suffix in (".hpp", ".cpp") and path.name != "config.hpp")
        settings = known_settings()
        self.assertGreater(len(settings), 50)
        dead = sorted(key for key in settings if not re.search(rf"\b{key.partition('.')[2]}\b", code))
        self.assertEqual(dead, [])

    def test_options_in_readme_exist(self):
        known = "".join((ROOT / "scripts" / script).read_text() for script in ("test", "bench", "report"))
        for program in ("run", "evaluate", "simulate", "calibrate"):
            path = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"]) / f"posefusion_{program}"
            known += subprocess.run([str(path), "--help"], stdout=subprocess.PIPE, text=True).stdout
        options = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", (ROOT / "README.md").read_text()))
        self.assertGreater(len(options), 10)
        for option in options:
            self.assertRegex(known, rf"(?<![\w-]){option}(?![\w-])", "README.md")

    def test_no_absolute_paths(self):
        absolute = re.compile(r"/(home|root|work|Users|mnt)/[A-Za-z]")
        tracked = list(files(*SOURCES, "config", "docs", "launch", "msg"))
        tracked += [p for p in ROOT.iterdir() if p.suffix in (".md", ".rst", ".xml", ".txt")]
        for path in tracked:
            try:
                text = path.read_text()
            except UnicodeDecodeError:
                continue
            for line in text.splitlines():
                self.assertIsNone(absolute.search(line), f"{name(path)}: {line}")

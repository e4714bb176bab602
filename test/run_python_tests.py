#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the unittest cases of a file and writes a JUnit report, as Google Test does.

Usage: run_python_tests.py TEST_FILE REPORT.xml [PROGRAM_DIR]
PROGRAM_DIR, where the package's programs are, is handed on as POSEFUSION_PROGRAMS.
"""
import importlib.machinery
import importlib.util
import os
import pathlib
import sys
import time
import unittest
import xml.etree.ElementTree as tree

sys.dont_write_bytecode = True


class Report(unittest.TextTestResult):
    """Keeps the result of each case, and the seconds that it took."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.cases = []

    def startTest(self, test):
        super().startTest(test)
        self.begun_s = time.monotonic()

    def stopTest(self, test):
        super().stopTest(test)
        case = tree.Element("testcase", classname=type(test).__name__, name=test._testMethodName,
                            time=f"{time.monotonic() - self.begun_s:.3f}")
        for kind, entries in (("failure", self.failures), ("error", self.errors),
                              ("skipped", self.skipped)):
            for failed, message in entries:
                if failed is test or getattr(failed, "test_case", None) is test:
                    tree.SubElement(case, kind, message=message)
        self.cases.append(case)


def main():
    file, report = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    if len(sys.argv) > 3:
        os.environ["POSEFUSION_PROGRAMS"] = sys.argv[3]
    sys.path.insert(0, str(file.parent))  # tests may use each other's helpers
    loader = importlib.machinery.SourceFileLoader(file.stem, str(file))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(file.stem, loader))
    loader.exec_module(module)
    cases = unittest.defaultTestLoader.loadTestsFromModule(module)
    result = unittest.TextTestRunner(verbosity=2, resultclass=Report).run(cases)
    suite = tree.Element("testsuite", name=file.stem, tests=str(result.testsRun))
    suite.extend(result.cases)
    report.parent.mkdir(parents=True, exist_ok=True)
    tree.ElementTree(suite).write(report, encoding="utf-8", xml_declaration=True)
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output folder with a small set of files, under kills and failing operations at 20 places, or at all with
MILLPOSE_FAULT_PLACES=all. Usage: folder_swap_test.py MILLPOSE TOP FAULTS DRIVER"""
import subprocess

from fault_fixture import ALL, CAUSES, DRIVER, Faults, is_clean, main, places, results, run


class Swap(Faults):
    def write(self, folder, letter):
        return DRIVER, folder, letter

    def test_a_kill_at_any_operation_leaves_one_whole_set(self):
        count = self.prepare()
        self.assertGreater(count, 60)
        repaired = self.kill_at(places(count, 24), again=lambda at: at % 3 == 0)
        self.assertGreater(repaired, 10 if ALL else 1, "the journal was never open")

    def test_the_first_set_appears_whole_or_not_at_all(self):
        self.prepare()
        self.new = results(self.a)
        for at in range(1, 200, 1 if ALL else 11):
            with self.subTest(killed_at=at):
                subprocess.run(["rm", "-rf", self.out], check=True)
                killed = run(self.write(self.out, "A"), self.out, at)
                if killed.returncode == 0:
                    self.assertGreater(at, 40)
                    return
                if (self.out / ".journal").exists():
                    self.assertEqual(subprocess.run([DRIVER, self.out, "-"], capture_output=True).returncode, 0)
                self.assertIn(results(self.out) if self.out.exists() else {}, ({}, self.new))

    def test_an_operation_that_fails_leaves_the_old_set(self):
        count = self.prepare()
        for fault in CAUSES:
            self.fail_at(places(count, 6), fault, stays=False)

    def test_a_disk_that_stays_full_leaves_the_old_set_or_one_that_is_mended(self):
        count = self.prepare()
        self.fail_at(places(count, 6), "ENOSPC", stays=True)

    def test_of_three_at_once_in_a_new_folder_those_refused_are_told_by_whom(self):
        for attempt in range(200 if ALL else 8):
            out = self.top / f"new{attempt}"
            runs = [subprocess.Popen(self.write(out, letter), stderr=subprocess.PIPE, text=True) for letter in "ABA"]
            errors = [process.communicate(timeout=60)[1] for process in runs]
            self.assertIn(0, [process.returncode for process in runs], errors)
            for process, error in zip(runs, errors):
                if process.returncode != 0:
                    self.assertEqual(process.returncode, 2, error)
                    self.assertRegex(error, r"another run works in this folder: process \d+ on ")
            self.assertTrue(is_clean(out))
            self.assertEqual(subprocess.run((DRIVER, out, "-"), stdout=subprocess.DEVNULL).returncode, 0)


class SwapOfSeveral(Swap):
    """The same with two operations, one of which the new set has no more."""

    def write(self, folder, letter):
        return DRIVER, folder, {"A": "C", "B": "D"}[letter]

    test_of_three_at_once_in_a_new_folder_those_refused_are_told_by_whom = None


class SwapToAndFromSeveral(Swap):
    """From a job of one operation to one of several."""

    def write(self, folder, letter):
        return DRIVER, folder, {"A": "A", "B": "D"}[letter]

    test_of_three_at_once_in_a_new_folder_those_refused_are_told_by_whom = None


if __name__ == "__main__":
    main()

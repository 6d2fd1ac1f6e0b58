# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: package_test.py BUILD_FOLDER install|deb: what `cmake --install` and CPack make, used as a stranger would."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
CONSUMER = pathlib.Path(__file__).resolve().parent / "consumer"
MIRROR = os.environ.get("MILLPOSE_DEBIAN_MIRROR", "http://deb.debian.org/debian")


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(str(c) for c in command)}: status {done.returncode}\n{done.stdout[-4000:]}"
                             f"\n{done.stderr[-4000:]}")
    return done.stdout


class TestWithFolder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="millpose_package_"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def assert_planned(self, folder):
        """A complete plan of the sample support_pad."""
        summary = json.loads((folder / "summary.json").read_text())
        self.assertGreater(summary["points"]["planned"], 100)
        self.assertEqual(summary["points"]["skipped"], 0)
        self.assertTrue(summary["programs"])
        for program in summary["programs"]:
            self.assertTrue(program["verified"], program)
            self.assertTrue((folder / program["path"]).is_file())


class Install(TestWithFolder):
    def test_consumer_builds_and_runs_and_so_does_the_program(self):
        prefix = self.folder / "prefix"
        run("cmake", "--install", BUILD, "--prefix", prefix)
        told = run("/usr/bin/python3", "-c", "import millpose; print(millpose.stiffness("
                   f"'{prefix}/share/millpose/cells/kr500_r2830.yaml', [0, -90, 90, 0, 30, 0]).compliance.shape)",
                   env={"PATH": f"{prefix}/bin:/usr/bin:/bin", "PYTHONPATH": str(prefix / "lib/python3/dist-packages")})
        self.assertEqual(told, "(6, 6)\n")
        self.assertTrue((prefix / "share/man/man1/millpose.1").is_file())
        run("cmake", "-S", CONSUMER, "-B", self.folder / "consumer", "-DCMAKE_PREFIX_PATH=" + str(prefix))
        run("cmake", "--build", self.folder / "consumer")
        t1, t2, n = (float(x) for x in run(self.folder / "consumer/pose_stiffness").split())
        self.assertGreaterEqual(t1, t2)
        for value in (t1, t2, n):
            self.assertTrue(1e-5 < value < 1e-2, value)
        run("sh", "-c", f"cp -r {prefix}/share/millpose {self.folder}/samples")
        job = self.folder / "samples/toolpaths/support_pad/job.yaml"
        run(self.folder / "consumer/plan_job", job, self.folder / "by_consumer")
        self.assert_planned(self.folder / "by_consumer")
        rows = run(self.folder / "consumer/own_objective", job).splitlines()
        self.assertEqual(len(rows), json.loads((self.folder / "by_consumer/summary.json").read_text())["points"]["total"])
        run(prefix / "bin/millpose", "plan", job, "-o", self.folder / "by_program", "--quiet")
        self.assert_planned(self.folder / "by_program")
        for name in ("points.csv", "summary.json", "report.html"):
            self.assertEqual((self.folder / "by_consumer" / name).read_bytes(),
                             (self.folder / "by_program" / name).read_bytes(), name)


class Deb(TestWithFolder):
    def test_package_works_in_a_clean_debian(self):
        self.assertEqual(os.geteuid(), 0, "debootstrap and chroot need root")
        run("cpack", "-G", "DEB", "-B", self.folder / "deb", cwd=BUILD)
        debs = sorted((self.folder / "deb").glob("*.deb"))
        self.assertEqual([deb.name.split("_")[0] for deb in debs], ["millpose", "python3-millpose"])
        depends = run("dpkg-deb", "--field", debs[0], "Depends")
        for library in ("libc6", "libstdc++6", "libfcl0.7", "libompl16", "libyaml-cpp0.7"):
            self.assertIn(library, depends)
        root = self.folder / "root"
        run("debootstrap", "--variant=minbase", "bookworm", root, MIRROR)
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C"}

        def install(deb):
            shutil.copy(deb, root / "package.deb")
            run("chroot", root, "apt-get", "install", "-y", "--no-install-recommends", "/package.deb", env=environment)

        install(debs[0])
        run("chroot", root, "sh", "-c", "cp -r /usr/share/millpose /samples && millpose plan --quiet "
            "/samples/toolpaths/support_pad/job.yaml -o /out")
        self.assert_planned(root / "out")
        self.assertEqual(run("chroot", root, "sh", "-c", "find /usr/include /usr/lib -name '*millpose*'"), "")
        install(debs[1])
        told = run("chroot", root, "python3", "-c", "import millpose; print(millpose.load('/out').joints_deg.shape[1], "
                   "millpose.stiffness('/samples/cells/kr500_r2830.yaml', [0, -90, 90, 0, 30, 0]).mu.shape)", env=environment)
        self.assertEqual(told, "6 ()\n")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], sys.argv[2].capitalize()], verbosity=2)

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Each rule of architecture.py finds its breach in a small made-up tree, and nothing else."""
import tempfile
import unittest
from pathlib import Path

import architecture

SPDX = "// SPDX-License-Identifier: GPL-3.0-or-later\n"
HEADER = SPDX + "#pragma once\n"


def write(top, name, text):
    path = Path(top) / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


class Rules(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.top = self.folder.name
        cmake = "# SPDX-License-Identifier: GPL-3.0-or-later\n"
        write(self.top, "lib/base/CMakeLists.txt", cmake + "millpose_module(base SOURCES file.cpp LINK xxhash)")
        write(self.top, "lib/base/file.cpp", SPDX + "#include <fstream>\n")
        write(self.top, "lib/machine/robot/CMakeLists.txt", cmake + "millpose_module(robot SOURCES arm.cpp USES base)")
        write(self.top, "lib/machine/robot/arm.hpp", HEADER + '#include "base/error.hpp"\n')
        write(self.top, "lib/planning/pose/CMakeLists.txt", cmake + "millpose_module(pose SOURCES a.cpp USES robot LINK fcl)")
        write(self.top, "lib/planning/pose/a.cpp", SPDX + '#include <fcl/fcl.h>\n#include "base/error.hpp"\n')

    def expect(self, *messages):
        found = architecture.problems(self.top)
        self.assertEqual(len(found), len(messages), found)
        for problem, message in zip(found, messages):
            self.assertIn(message, problem)

    def test_good_tree(self):
        self.expect()

    def test_module_that_is_not_linked(self):
        write(self.top, "lib/machine/robot/arm.cpp", SPDX + '#include "planning/pose/search.hpp"\n')
        self.expect("machine/robot does not use planning/pose")

    def test_cycle(self):
        write(self.top, "lib/base/CMakeLists.txt",
              "# SPDX-License-Identifier: GPL-3.0-or-later\nmillpose_module(base SOURCES a.cpp USES pose)")
        self.expect("cycle", "cycle", "cycle", "base uses pose of a later room")

    def test_a_module_of_a_later_room(self):
        write(self.top, "lib/run/batch/CMakeLists.txt",
              "# SPDX-License-Identifier: GPL-3.0-or-later\nmillpose_module(batch SOURCES a.cpp USES base)")
        write(self.top, "lib/machine/robot/CMakeLists.txt",
              "# SPDX-License-Identifier: GPL-3.0-or-later\nmillpose_module(robot SOURCES arm.cpp USES base batch)")
        self.expect("robot uses batch of a later room")

    def test_a_folder_that_is_no_room(self):
        write(self.top, "lib/kept/a.hpp", HEADER)
        self.expect("lib/kept is no room")

    def test_judge_that_knows_the_planner(self):
        write(self.top, "lib/audit/CMakeLists.txt",
              "# SPDX-License-Identifier: GPL-3.0-or-later\nmillpose_module(judge SOURCES a.cpp USES base pose)")
        self.expect("judge uses pose, robot; allowed: base alone")

    def test_hidden_library_in_header(self):
        write(self.top, "lib/machine/robot/arm.hpp", HEADER + "#include <fcl/fcl.h>\n")
        self.expect("shows fcl/fcl.h")

    def test_adapter_may_show_its_library(self):
        write(self.top, "lib/machine/robot/fcl_shapes.hpp", HEADER + "#include <fcl/fcl.h>\n")
        self.expect()

    def test_file_opened_outside_base(self):
        for text in ("#include <fstream>\n", "auto f = fopen(name);\n", "std::ofstream out(name);\n"):
            write(self.top, "lib/machine/robot/arm.cpp", SPDX + text)
            self.expect("only lib/base does")

    def test_the_c_librarys_trigonometry(self):
        for text in ("double a = std::sin(b);\n", "double a = hypot(b, c);\n", "auto a = ::powf(b, c);\n", "using std::exp;\n",
                     "const Eigen::AngleAxisd turn(a, axis);\n", "auto a = first.slerp(t, second);\n",
                     "const auto a = b.array().log();\n", "std::normal_distribution<double> d;\n", "double a = std::log1p(b);\n"):
            write(self.top, "lib/machine/robot/arm.cpp", SPDX + text)
            self.expect("arm.cpp:2: ")
        write(self.top, "lib/machine/robot/arm.cpp", SPDX)
        write(self.top, "tests/golden/golden_test.cpp", SPDX + "double a = std::acos(b);\n")
        self.expect("golden_test.cpp:2: std::acos( differs between processors; use base/trig.hpp")

    def test_trigonometry_of_our_own_and_in_words(self):
        write(self.top, "lib/machine/robot/arm.cpp", SPDX + '// sin(a)\nauto text = "cos(q)"; /* pow(a,\nb) */ a = Asin(b) + SinCos(c).sin + '
              'Pow(a, b) + Log(d) + t.exp + catalog(e) + record.log_at(f) + std::sqrt(g);\n')
        self.expect()

    def test_a_type_defined_twice(self):
        write(self.top, "lib/machine/robot/arm.hpp", SPDX + "#pragma once\nnamespace millpose {\nstruct Part {\n  int a;\n};\n}\n")
        write(self.top, "tests/arm_test.cpp", SPDX + "namespace millpose {\nclass Part final : Base<int> {};\n}\n")
        self.expect("millpose::Part is defined in lib/machine/robot/arm.hpp too")
        for other in ("namespace millpose {\nnamespace {\nstruct Part {};\n}\n}\n", "namespace millpose {\nclass Part;\n}\n",
                      "namespace millpose {\nstruct Whole {\n  struct Part {};\n};\nstruct Whole::Part {};\n}\n",
                      "// struct Part {\nnamespace millpose::audit {\nstruct Part {};\n}\n"):
            write(self.top, "tests/arm_test.cpp", SPDX + other)
            self.expect()

    def test_a_module_of_python_that_no_package_brings(self):
        spdx = "# SPDX-License-Identifier: GPL-3.0-or-later\n"
        write(self.top, "tests/helper.py", spdx)
        write(self.top, "tests/x.py", spdx + "import json\nimport helper\nimport os.path, yaml\nfrom numpy.linalg import inv\n")
        self.expect("tests/x.py:4: no package of packages.txt brings yaml", "tests/x.py:5: no package of packages.txt brings numpy")
        write(self.top, "packages.txt", "cmake\npython3-numpy\npython3-yaml\n")
        self.expect()

    def test_missing_licence_line(self):
        write(self.top, "tests/x.py", "#!/usr/bin/env python3\nprint()\n")
        self.expect("SPDX")

    def test_missing_pragma(self):
        write(self.top, "lib/machine/robot/arm.hpp", SPDX)
        self.expect("#pragma once")


if __name__ == "__main__":
    unittest.main()

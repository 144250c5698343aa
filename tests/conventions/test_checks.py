"""Each check fails on a bad example, says where, and lets a good one pass."""

import importlib.machinery
import importlib.util
import pathlib
import subprocess
import tempfile
import unittest

import architecture
import arrows
import documents
import elementary
import exceptions
import figures
import format as formatting
import method
import paths
import readmes
import sizes
import sources
import units


class Architecture(unittest.TestCase):
    QUESTIONS = "## Ten questions\n" + "".join(f"{i}. Who?\n   - `rt/a.cpp`: `f`\n" for i in range(1, 11))
    FILES = {"rt/a.cpp": "int f() { return 1; }", architecture.DOCUMENT: QUESTIONS}

    def found(self, document):
        return architecture.problems(self.FILES | {architecture.DOCUMENT: document})

    def test_lets_what_exists_pass(self):
        self.assertEqual(self.found(self.QUESTIONS), [])

    def test_refuses_names_of_nothing(self):
        self.assertIn("firmware/architecture.md:1: rt/b.cpp does not exist", self.found("`rt/b.cpp`\n" + self.QUESTIONS))
        self.assertIn("firmware/architecture.md:1: rt/a.cpp has no function g", self.found("`rt/a.cpp`: `g`\n" + self.QUESTIONS))

    def test_refuses_long_walks_and_missing_questions(self):
        hop = "   - `rt/a.cpp`: `f`\n"
        self.assertIn("question 10 takes 4 hops", self.found(self.QUESTIONS + 3 * hop)[0])
        self.assertIn("9 questions; must be ten", self.found(self.QUESTIONS.replace("10. Who?\n" + hop, ""))[0])


class Picture(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tool = pathlib.Path(__file__).resolve().parents[2] / "tools/architecture"
        loader = importlib.machinery.SourceFileLoader("picture", str(tool))
        cls.picture = importlib.util.module_from_spec(importlib.util.spec_from_loader("picture", loader))
        loader.exec_module(cls.picture)

    def test_folders_that_include_each_other_share_a_box(self):
        self.assertEqual(self.picture.boxes({"a": {"b"}, "b": {"a", "c"}, "c": set()}), {"a": ("a", "b"), "b": ("a", "b"), "c": ("c",)})

    def test_what_follows_from_other_lines_is_left_out(self):
        lines = self.picture.reduced({"a": {"b", "c"}, "b": {"c"}, "c": set()})
        self.assertEqual(lines, {("a",): {("b",)}, ("b",): {("c",)}, ("c",): set()})
        self.assertEqual(self.picture.rows(lines), [[("a",)], [("b",)], [("c",)]])


class Arrows(unittest.TestCase):
    def only_problem(self, files):
        found = arrows.problems(files)
        self.assertEqual(len(found), 1, found)
        return found[0]

    def test_refuses_an_arrow_that_is_not_allowed(self):
        for path, target in [
            ("core/base/rng.hpp", "core/geometry/pose2.hpp"),
            ("core/geometry/pose2.hpp", "core/base/rng.hpp"),
            ("core/ndt/ndt.cpp", "rt/cpu_clock.hpp"),
            ("rt/queue.hpp", "core/scan/scan_frame.hpp"),
            ("drivers/lrf/scip.cpp", "core/slam/lslam.hpp"),
            ("config/load.cpp", "firmware/stage.hpp"),
            ("firmware/stage.cpp", "tools/sim/world.hpp"),
            ("tools/main.cpp", "tests/support/scans.hpp"),
        ]:
            problem = self.only_problem({path: f'\n#include "{target}"\n'})
            self.assertIn(f"{path}:2: {arrows.part(path)} may not include {arrows.part(target)}", problem)

    def test_lets_the_allowed_ones_pass(self):
        for path, target in [
            ("core/ndt/ndt.cpp", "core/scan/scan_frame.hpp"),
            ("rt/queue.hpp", "core/base/check.hpp"),
            ("drivers/lrf/scip.cpp", "core/scan/scan_frame.hpp"),
            ("config/load.cpp", "core/base/parameters.hpp"),
            ("tools/main.cpp", "firmware/stage.hpp"),
            ("tests/core/ndt_test.cpp", "tools/sim/world.hpp"),
        ]:
            self.assertEqual(arrows.problems({path: f'#include "{target}"\n'}), [])

    def test_refuses_a_circle_of_files(self):
        files = {
            "core/ndt/a.hpp": '#include "core/ndt/b.hpp"',
            "core/ndt/b.hpp": '#include "core/ndt/c.hpp"',
            "core/ndt/c.hpp": '#include "core/ndt/a.hpp"',
        }
        self.assertIn("core/ndt/a.hpp -> core/ndt/b.hpp -> core/ndt/c.hpp -> core/ndt/a.hpp", self.only_problem(files))

    def test_refuses_a_circle_of_folders_of_the_core(self):
        files = {
            "core/grid/a.hpp": '#include "core/slam/b.hpp"',
            "core/slam/c.hpp": '#include "core/grid/d.hpp"',
        }
        self.assertIn("circle of folders: core/grid -> core/slam -> core/grid", self.only_problem(files))

    def test_refuses_a_path_that_is_not_from_the_root(self):
        self.assertIn("by its path from the root", self.only_problem({"rt/clock.cpp": '#include "clock.hpp"'}))

    def test_refuses_clocks_and_files_in_the_core_alone(self):
        self.assertIn("core/ndt/a.cpp:1: <chrono>", self.only_problem({"core/ndt/a.cpp": "#include <chrono>"}))
        self.assertEqual(arrows.problems({"rt/clock.cpp": "#include <chrono>", "core/a/b.cpp": "#include <cmath>"}), [])


class Elementary(unittest.TestCase):
    def test_refuses_functions_of_the_library(self):
        for bad in ["std::sin(x)", "::exp(x)", "atan2f(y, x)", "std::pow(x, 2)", "apply(std::log)", "a.array().exp()", "Eigen::AngleAxisd turn"]:
            found = elementary.problems({"core/a/b.cpp": f"int a;\nauto b = {bad};\n"})
            self.assertEqual(len(found), 1, bad)
            self.assertIn("core/a/b.cpp:2: ", found[0])

    def test_lets_own_and_exact_ones_pass(self):
        good = "auto a = math::sin(x) + std::sqrt(y) + std::remainder(x, y) + log_sum(x) + sin_ * cos;  // exp(x)\n"
        self.assertEqual(elementary.problems({"core/a/b.cpp": good}), [])
        self.assertEqual(elementary.problems({"core/math/b.cpp": "exp(x)", "tools/output/a.cpp": "std::sin(x)"}), [])


class Sizes(unittest.TestCase):
    def test_refuses_a_long_file(self):
        self.assertEqual(sizes.problems({"rt/a.cpp": "\n" * 400}), [])
        self.assertEqual(sizes.problems({"rt/a.cpp": "\n" * 401}), ["rt/a.cpp: 401 lines; at most 400"])

    def test_refuses_a_long_function(self):
        def function(lines):
            return "\nint f() {\n" + "  g();\n" * (lines - 2) + "}\n"

        self.assertEqual(sizes.problems({"rt/a.cpp": function(60)}), [])
        self.assertEqual(sizes.problems({"rt/a.cpp": function(61)}), ["rt/a.cpp:2: f has 61 lines; at most 60"])

    def test_refuses_many_parameters(self):
        self.assertEqual(sizes.problems({"rt/a.hpp": "void f(int a, int b, int c, int d, int e);"}), [])
        for text in [
            "void f(int a, int b, int c, int d, int e, int g);",
            "class A {\n public:\n  void f(int a, int b, int c, int d, int e, int g);\n};",
            "void A::f(int a, int b, int c, int d, int e, int g) const {}",
        ]:
            self.assertIn("f has 6 parameters; at most 5", sizes.problems({"rt/a.hpp": text})[0])


class Units(unittest.TestCase):
    def flagged(self, text):
        return [problem.split(": ")[1].split()[0] for problem in units.problems({"rt/a.hpp": text})]

    def test_refuses_quantities_without_a_unit(self):
        for name in "range yaw_ cell_size range_max kTimeout robot_width max_speed".split():
            self.assertEqual(self.flagged(f"double {name} = 0.0;"), [name])
        self.assertEqual(self.flagged("void f(double range, const float& yaw);"), ["range", "yaw"])
        self.assertEqual(self.flagged("std::vector<float> ranges_;"), ["ranges_"])
        self.assertEqual(self.flagged("std::int64_t stamp = 0;"), ["stamp"])
        self.assertEqual(self.flagged("double distance(Point2 a, Point2 b);"), ["distance"])

    def test_says_where(self):
        self.assertIn("rt/a.hpp:3: yaw needs", units.problems({"rt/a.hpp": "// double range\n\ndouble yaw;\n"})[0])

    def test_lets_units_and_plain_numbers_pass(self):
        good = """
            double range_m; float yaw_rad_{}; std::span<const float> ranges_m; double kCellSizeM = 1.0; double fitness;
            double crossover_rate; double inverse_cell_size; double wrap_angle(double angle_rad); int size() const;
            std::int64_t stamp_ns; std::size_t size; const double c = std::cos(yaw_rad); double x; // double range
        """
        self.assertEqual(self.flagged(good), [])


class Paths(unittest.TestCase):
    def test_refuses_a_developers_place(self):
        for place in ["/ho" "me/ann/log", "/wo" "rk/main", "/Us" "ers/ann", "/t" "mp/out"]:
            self.assertEqual(len(paths.problems({"tools/demo": f"\nopen {place}\n"})), 1, place)

    def test_lets_other_paths_pass(self):
        text = "https://example.org/wo" "rk/in/progress ${root}/wo" "rk/x ../ho" "me/ann /usr/share /dev/null"
        self.assertEqual(paths.problems({"tools/demo": text}), [])
        self.assertEqual(paths.problems({"tests/tools/a.cpp": '"/t' 'mp"'}), [])


class Readmes(unittest.TestCase):
    def test_refuses_a_folder_without_one(self):
        files = {"README.md": "x", "rt/README.md": "x", "rt/a.cpp": "", "core/base/a.cpp": "", ".ci/run": ""}
        self.assertEqual(readmes.problems(files), ["core/README.md: missing"])
        self.assertEqual(readmes.problems(files | {"core/README.md": "what it is"}), [])


class Method(unittest.TestCase):
    PAPER = "## 1. NDT\nFiles: `ndt/ndt.hpp`\n\n## 2. Bibliography\n- **[biber2003ndt]** P. Biber.\n"

    def found(self, header, paper=PAPER, path="core/ndt/ndt.hpp"):
        return method.problems({method.PAPER: paper, path: header})

    def test_lets_a_cited_source_pass_that_names_its_section(self):
        self.assertEqual(self.found("// [biber2003ndt, section III;\n/// method 1]"), [])

    def test_refuses_a_citation_that_leads_nowhere(self):
        self.assertIn("[magnusson2009ndt] is not in the bibliography", self.found("// [biber2003ndt, magnusson2009ndt; method 1]")[0])
        self.assertIn("core/ndt/ndt.hpp:2: says no section", self.found("\n// [biber2003ndt]")[0])
        self.assertIn("section 2 of core/method.md does not name this file", self.found("// [biber2003ndt; method 2]")[0])

    def test_refuses_a_section_without_its_file_and_a_folder_without_a_section(self):
        found = self.found("// [biber2003ndt; method 1]", path="core/grid/cell.hpp")
        self.assertIn("core/method.md: section 1 names core/ndt/ndt.hpp, which does not exist", found)
        self.assertIn("core/method.md: no section names a file of core/grid", found)

    def test_refuses_an_entry_that_nobody_cites(self):
        self.assertEqual(self.found("int a;"), ["core/method.md: [biber2003ndt] is cited nowhere"])


class Documents(unittest.TestCase):
    def test_refuses_a_long_readme_of_a_folder(self):
        self.assertEqual(documents.problems({"rt/README.md": "a\n" * 80, "README.md": "a\n" * 200}, {}), [])
        self.assertIn("rt/README.md: 81 lines; at most 80", documents.problems({"rt/README.md": "a\n" * 81}, {})[0])

    def test_refuses_decisions_without_number_or_date(self):
        good = "# D\n\n- **D1** (2026-01-02) So.\n  It is.\n- **D2** (2026-01-03) Or so.\n"
        self.assertEqual(documents.problems({"rt/DECISIONS.md": good}, {}), [])
        for bad in (good.replace("D2", "D3"), good.replace(" (2026-01-03)", ""), good + "- And so on.\n"):
            self.assertIn("numbered from 1 without a gap", documents.problems({"rt/DECISIONS.md": bad}, {})[0])

    def test_refuses_words_in_documents_and_texts_for_users_alone(self):
        text = 'say("the pose is in doubt");\n'
        for path in ("rt/a.cpp", "core/README.md"):
            self.assertIn(f"{path}:1: /", documents.problems({path: text}, {})[0])
        for path, other in (("tests/rt/a.cpp", text), ("rt/a.cpp", "// in doubt\nint doubt;\n"), ("rt/a.cpp", 'key("doubt")')):
            self.assertEqual(documents.problems({path: other}, {}), [])

    def test_refuses_links_that_lead_nowhere(self):
        files = {"rt/README.md": "[a](../core/a.md#b) [c](https://example.org) [d](../core)", "core/a.md": ""}
        self.assertEqual(documents.problems(files, {}), [])
        self.assertEqual(documents.problems(files | {"rt/README.md": "\n[e](e.md)"}, {}), ["rt/README.md:2: e.md leads nowhere"])

    def test_lets_no_more_and_no_fewer_uses_pass_than_are_known(self):
        text, word = "torn, and torn\n", r"\btorn\b"
        self.assertEqual(documents.problems({"a.md": text}, {("a.md", word): 2}), [])
        self.assertIn("2 times (lines 1, 1), 1 known", documents.problems({"a.md": text}, {("a.md", word): 1})[0])
        self.assertIn("2 times now and not 3", documents.problems({"a.md": text}, {("a.md", word): 3})[0])
        self.assertEqual(documents.in_use("2 a.md \\btorn\\b\n"), {("a.md", word): 2})


class Figures(unittest.TestCase):
    KNOWN = "| log | path, median | CPU, median |\n|---|---|---|\n| Court, each scan | 0.040 m, 0.42 deg | 9 ms |\n"

    def found(self, text, path="core/README.md"):
        return figures.problems({figures.HOME: self.KNOWN, path: text})

    def table(self, cell, log="Court, each scan"):
        return f"| log | by others | path, median |\n|---|---|---|\n| {log} | 0.9 m | {cell} |\n"

    def test_lets_what_is_near_pass(self):
        for text in (self.table("0.031 m, 0.54 deg"), "Court, 250 m by 20 m.\n\nA room: 0.1 m.\n", "Court\n\n| a | b |\n| x | 0.1 m |\n"):
            self.assertEqual(self.found(text), [])
        self.assertEqual(self.found("Court: 3.5 m\n", "core/DECISIONS.md"), [])

    def test_refuses_what_is_not(self):
        for cell in ("0.030 m, 0.42 deg", "0.053 m, 0.42 deg", "0.040 m", "0.040 m, 0.42 m", "good"):
            self.assertIn(f"core/README.md:3: Court, each scan, path, median: {cell}; tests/results.md has 0.040 m, 0.42 deg", self.found(self.table(cell)))

    def test_refuses_figures_elsewhere(self):
        for line, text in ((1, "On Court the\nerror is 0.04 m.\n"), (2, "\nCourt takes 9 ms.\n"), (3, self.table("0.04 m", "Court"))):
            self.assertIn(f"core/README.md:{line}: a figure of a recorded log that tests/results.md", self.found(text)[0])


class Exceptions(unittest.TestCase):
    def test_refuses_them_where_nothing_may_throw(self):
        text = "// throw in a comment\nvoid f() {\n  throw 1;\n}\n"
        self.assertEqual(len(exceptions.problems({"core/a/b.cpp": text})), 1)
        self.assertIn("core/a/b.cpp:3: throw", exceptions.problems({"core/a/b.cpp": text})[0])
        self.assertEqual(exceptions.problems({"config/b.cpp": text}), [])


class Format(unittest.TestCase):
    def test_refuses_what_clang_format_would_change(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "good.cpp").write_text("int f() { return 1; }\n")
            (pathlib.Path(folder) / "bad.cpp").write_text("int f( )\n{ return 1; }\n")
            (pathlib.Path(folder) / ".clang-format").write_text("BasedOnStyle: Google\n")
            self.assertEqual(formatting.problems(["good.cpp"], folder), [])
            self.assertEqual(
                formatting.problems(["good.cpp", "bad.cpp"], folder),
                ["bad.cpp: not formatted; run: clang-format -i bad.cpp"],
            )


class Sources(unittest.TestCase):
    def test_are_those_of_git_with_new_ones_but_nothing_built(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            subprocess.run(["git", "init", "--quiet", folder], check=True)
            (root / ".gitignore").write_text("/build/\n")
            (root / "build").mkdir()
            for name in ("new.cpp", "build/made.cpp"):
                (root / name).write_text("int a;\n")
            (root / "picture.bin").write_bytes(b"\0\1")
            self.assertEqual(sorted(sources.read_all(root)), [".gitignore", "new.cpp"])

    def test_are_found_without_git_too(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("a.cpp", "build/made.cpp"):
                (root / name).parent.mkdir(exist_ok=True)
                (root / name).write_text("int a;\n")
            self.assertEqual(sorted(sources.read_all(root)), ["a.cpp"])


if __name__ == "__main__":
    unittest.main()

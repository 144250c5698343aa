"""The function finder on what our sources are made of."""

import unittest

import cpp_source


def found(text):
    return [(f.name, f.line, f.lines, len(f.parameters)) for f in cpp_source.functions(cpp_source.strip(text))]


class Strip(unittest.TestCase):
    def test_removes_comments_strings_and_directives_and_keeps_lines(self):
        text = '#define A(x) \\\n  { x\nint a; // {\n/* {\n */ const char* b = "{\\"{"; char c = \'{\'; int d = 1\'000;\n'
        stripped = cpp_source.strip(text)
        self.assertNotIn("{", stripped)
        self.assertEqual(stripped.count("\n"), text.count("\n"))
        self.assertIn("1'000", stripped)

    def test_removes_raw_strings(self):
        self.assertNotIn("{", cpp_source.strip('auto a = R"({\n"{")"; auto b = R"x({)")x";'))


class Functions(unittest.TestCase):
    def test_finds_free_functions_and_their_lines(self):
        self.assertEqual(found("\nint f(int a,\n      int b) {\n  return a;\n}\n"), [("f", 2, 4, 2)])

    def test_finds_methods_with_qualifiers_and_return_types(self):
        text = """namespace a {
class B {
 public:
  [[nodiscard]] bool f() const noexcept { return true; }
  auto g(int a) const -> std::vector<int> { return {a}; }
  B operator*(const B& other) const { return *this; }
  bool operator()(int a, int b) { return a < b; }
};
}  // namespace a
"""
        self.assertEqual(
            [(n, c) for n, _, _, c in found(text)], [("f", 0), ("g", 1), ("operator*", 1), ("operator()", 2)]
        )

    def test_finds_constructors_with_initialisers(self):
        text = "A::A(int a, int b) : a_{a}, b_(b), c_{{1, 2}} {\n  f();\n}\nA::~A() {}\n"
        self.assertEqual(found(text), [("A", 1, 3, 2), ("~A", 4, 1, 0)])

    def test_counts_parameters_at_the_top_alone(self):
        text = "void f(std::map<int, int> a, void (*g)(int, int), int b[2], Range r = {1, 2}) {}\n"
        self.assertEqual(found(text), [("f", 1, 1, 4)])

    def test_takes_no_control_statement_and_no_initialiser_for_a_function(self):
        text = """void f() {
  for (int i = 0; i < 3; ++i) { g(i); }
  if (const int a = g(1); a > 0) { g(a); } else if (h()) { g(2); } else { g(3); }
  while (true) { break; }
  switch (a) { case 1: { g(1); } }
  const A a{.b = f(1), .c = {1, 2}};
  return A{1, 2};
}
"""
        self.assertEqual(found(text), [("f", 1, 8, 0)])

    def test_finds_lambdas_inside_calls(self):
        text = "void f() {\n  sort(a, b, [&](int c, int d) {\n    return c < d;\n  });\n  g([] { h(); });\n}\n"
        self.assertEqual(found(text), [("lambda", 2, 3, 2), ("lambda", 5, 1, 0), ("f", 1, 6, 0)])

    def test_finds_declarations_but_no_calls(self):
        text = "int f(int a, int b);\nclass A {\n  A(int a);\n  int b_ = g(1, 2);\n};\nvoid h() { f(1, 2); }\n"
        self.assertEqual([(n, c) for n, _, _, c in found(text)], [("f", 2), ("A", 1), ("h", 0)])

    def test_survives_brackets_that_do_not_match(self):
        for text in ["}", "{{{", "f(", ")", "void f() { ( }", "]("]:
            found(text)


if __name__ == "__main__":
    unittest.main()

"""Sizes: a file has at most 400 lines, a function 60 lines and 5 parameters."""

import cpp_source
import sources

FILE_LINES_MAX = 400
FUNCTION_LINES_MAX = 60
PARAMETERS_MAX = 5

WRITTEN_BY_HAND = (".cpp", ".hpp", ".py", ".cmake", ".sh", "CMakeLists.txt")


def problems(files):
    found = []
    for path, text in files.items():
        lines = text.count("\n")
        if path.endswith(WRITTEN_BY_HAND) and lines > FILE_LINES_MAX:
            found.append(f"{path}: {lines} lines; at most {FILE_LINES_MAX}")
        if sources.is_cpp(path):
            found += function_problems(path, text)
    return found


def function_problems(path, text):
    for function in cpp_source.functions(cpp_source.strip(text)):
        where = f"{path}:{function.line}: {function.name}"
        if function.lines > FUNCTION_LINES_MAX:
            yield f"{where} has {function.lines} lines; at most {FUNCTION_LINES_MAX}"
        if len(function.parameters) > PARAMETERS_MAX:
            yield f"{where} has {len(function.parameters)} parameters; at most {PARAMETERS_MAX}"

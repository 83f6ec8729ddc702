"""Turn a pFUnit test file (.pf) into Fortran for the substitute module `funit`.

    python3 preprocess.py test_x.pf test_x.F90

The output holds the module, annotations expanded, and a subroutine `test_x_suite` that runs its
tests. Every file accepted here is meant to be accepted by pFUnit 4.14; where pFUnit would fail
late or quietly do something else, the file is refused here with `file:line: why`.
"""
import re
import sys
from pathlib import Path

MAX_NAME = 43  # pFUnit derives longer names from these

# Number of operands, keywords that may follow them, how many of these may go without keyword.
COMPARISON = {"operands": 2, "keywords": {"message"}}
ASSERTS = {
    "equal": {"operands": 2, "keywords": {"tolerance", "message"}},
    "relativelyequal": {"operands": 2, "keywords": {"tolerance", "message"}, "positional": 1},
    "notequal": COMPARISON,
    "lessthan": COMPARISON,
    "lessthanorequal": COMPARISON,
    "greaterthan": COMPARISON,
    "greaterthanorequal": COMPARISON,
    "sameshape": COMPARISON,
    "true": {"operands": 1, "keywords": {"message"}, "positional": 1},
    "false": {"operands": 1, "keywords": {"message"}, "positional": 1},
    "isnan": {"operands": 1, "keywords": {"message"}},
    "isfinite": {"operands": 1, "keywords": {"message"}},
    "associated": {"operands": 1, "keywords": {"message"}, "positional": 1},
    "fail": {"operands": 1, "keywords": set()},
    "exceptionraised": {"operands": 0, "keywords": set(), "positional": 1},
}


class Refused(Exception):
    """The file would not work under pFUnit (line 0: the file as a whole)."""

    def __init__(self, line, why):
        super().__init__(why)
        self.line = line


def blank_texts(line):
    """The line with quoted texts blanked out and the comment cut off, columns kept."""
    out, quote = [], ""
    for character in line:
        if quote:
            quote = "" if character == quote else quote
            out.append(" " if quote else character)
        elif character == "!":
            break
        else:
            quote = character if character in "\"'" else ""
            out.append(character)
    return "".join(out)


def split_arguments(text):
    """Split at the commas that lie outside brackets and quotes."""
    parts, depth, start = [], 0, 0
    for i, character in enumerate(blank_texts(text)):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    parts.append(text[start:].strip())
    return [] if parts == [""] else parts


class Translator:
    """Reads one .pf file; `run` gives the Fortran text or raises Refused."""

    def __init__(self, path):
        self.path = Path(path)
        self.name = self.path.stem
        self.lines = self.path.read_text(encoding="utf-8").splitlines()
        self.out = []
        self.tests = []       # dictionaries: name, line, argument, disabled, cases, testParameters
        self.fixtures = {}    # "before", "after", "testcase", "testparameter" -> name
        self.options = {}     # options of @testCase and @testParameter
        self.pending = None   # annotation that waits for its subroutine or type, with its line

    def run(self):
        self.check_module()
        for number, line in enumerate(self.lines, 1):
            code = blank_texts(line).strip()
            if code.startswith("@"):
                self.annotation(number, line.strip(), code)
                continue
            if re.search(r"@\s*\w", code):
                raise Refused(number, "an annotation has its line to itself")
            if self.pending and code:
                self.declaration(number, line)
            self.out.append(line)
        if self.pending:
            raise Refused(self.pending["line"], "the annotation is followed by nothing")
        self.check_tests()
        return "\n".join(self.out + self.suite()) + "\n"

    def check_module(self):
        """One module, named like the file, alone on its line, that uses funit."""
        code = [(n, blank_texts(line).strip().lower()) for n, line in enumerate(self.lines, 1)]
        code = [(n, text) for n, text in code if text]
        self.check_name(0, self.name)
        if not code or not re.fullmatch(rf"module\s+{self.name.lower()}", code[0][1]):
            line = code[0][0] if code else 0
            raise Refused(line, f"the file must open with `module {self.name}`")
        first = code[0][0]
        if "!" in self.lines[first - 1]:
            raise Refused(first, "no comment behind the module statement")
        if not re.match(r"end\s*module\b", code[-1][1]):
            raise Refused(code[-1][0], "nothing may follow the module")
        for number, text in code[1:]:
            if re.fullmatch(r"module\s+(?!procedure\b)\w+", text):
                raise Refused(number, "one module per file")
        if not any(re.match(r"use\s*(::)?\s*funit\b", text) for _, text in code):
            raise Refused(first, "`use funit` is missing")

    def annotation(self, number, line, code):
        match = re.fullmatch(r"@(\w+)\s*(\(.*\))?", code)
        if "!" in line[len(code):]:
            raise Refused(number, "no comment behind an annotation")
        if code.endswith("&"):
            raise Refused(number, "an annotation is one line, without &")
        if not match or code.count("(") != code.count(")"):
            raise Refused(number, "an annotation is @name or @name(...) with brackets closed")
        word = match[1].lower()
        arguments = line[match.start(2) + 1:-1] if match[2] else None
        if self.pending and not (word == "disable" and self.pending["kind"] == "test"):
            raise Refused(number, f"@{self.pending['kind']} still waits for its declaration")
        if word.startswith("assert") and word[6:] in ASSERTS:
            self.out.append(self.expand(number, match[1], arguments))
        elif word in ("test", "before", "after", "disable", "testcase", "testparameter"):
            self.mark(number, word, arguments)
            self.out.append("!" + line)
        else:
            raise Refused(number, f"unknown annotation @{match[1]}")

    def expand(self, number, name, text):
        """The call behind an assert annotation."""
        rule = ASSERTS[name[6:].lower()]
        if text is None:
            raise Refused(number, f"@{name} needs parentheses")
        arguments = split_arguments(text)
        if "" in arguments:
            raise Refused(number, f"@{name} has an empty argument")
        operands, extra = arguments[:rule["operands"]], arguments[rule["operands"]:]
        keyword = re.compile(r"(\w+)=(?!=)")
        if len(operands) < rule["operands"] or any(keyword.match(each) for each in operands):
            raise Refused(number, f"@{name} takes {rule['operands']} positional arguments")
        positional = [each for each in extra if not keyword.match(each)]
        words = [keyword.match(each)[1].lower() for each in extra[len(positional):]
                 if keyword.match(each)]
        if len(positional) > rule.get("positional", 0) or extra[:len(positional)] != positional:
            raise Refused(number, f"@{name}: give the arguments behind the operands by keyword")
        if len(set(words)) < len(words) or not set(words) <= rule["keywords"]:
            raise Refused(number, f"@{name}: allowed keywords are {sorted(rule['keywords'])}")
        if name.lower() == "assertrelativelyequal" and not positional and "tolerance" not in words:
            raise Refused(number, "@assertRelativelyEqual needs a tolerance")
        if name.lower() == "assertassociated":
            name, arguments = "assertTrue", [f"associated({', '.join(operands + positional)})"]
            arguments += extra[len(positional):]
        arguments.append(f"location=SourceLocation('{self.path.name}', {number})")
        return f"call {name}({', '.join(arguments)}); if (anyExceptions()) return"

    def mark(self, number, word, arguments):
        """Remember an annotation until the subroutine or type that follows it."""
        if word == "disable":
            if not (self.pending and self.pending["kind"] == "test") or arguments is not None:
                raise Refused(number, "@disable stands between @test and its subroutine")
            self.pending["disabled"] = True
            return
        if word in self.fixtures:
            raise Refused(number, f"only one @{word} per file")
        self.pending = {"kind": word, "line": number}
        if word in ("before", "after"):
            if arguments is not None:
                raise Refused(number, f"@{word} takes no arguments")
            return
        allowed = {"test": ("cases", "testParameters"), "testparameter": ("constructor",),
                   "testcase": ("constructor", "testParameters")}[word]
        for item in split_arguments(arguments or ""):
            match = re.fullmatch(r"(\w+)\s*=\s*(.+)", item)
            if not match or match[1] not in allowed or match[1] in self.pending:
                raise Refused(number, f"@{word} takes {' and '.join(allowed)} only")
            form = {"cases": r"\[\s*\d+(\s*,\s*\d+)*\s*\]", "testParameters": r"\{.+\}",
                    "constructor": r"\w+"}[match[1]]
            if not re.fullmatch(form, match[2]):
                raise Refused(number, f"{match[1]} is not of the form pFUnit reads")
            self.pending[match[1]] = match[2][1:-1] if match[1] == "testParameters" else match[2]

    def declaration(self, number, line):
        """The subroutine or type that a pending annotation belongs to."""
        pending, self.pending = self.pending, None
        if pending["kind"] in ("testcase", "testparameter"):
            match = re.fullmatch(r"\s*type\s*,[^!]*::\s*(\w+)\s*", line, re.IGNORECASE)
            what = "a line `type, extends(...) :: name`"
        else:
            match = re.fullmatch(r"\s*subroutine\s+(\w+)\s*\(\s*(\w*)\s*\)\s*", line, re.IGNORECASE)
            what = "a line `subroutine name()`, or `name(this)` with @testCase"
        if not match:
            raise Refused(number, f"@{pending['kind']} needs {what}, nothing behind it")
        self.check_name(number, match[1])
        if pending["kind"] == "test":
            self.tests.append(dict(pending, name=match[1], argument=match[2], line=number))
        else:
            if pending["kind"] in ("before", "after") and match[2]:
                raise Refused(number, f"a @{pending['kind']} subroutine takes no argument")
            self.fixtures[pending["kind"]] = match[1]
            self.options[pending["kind"]] = pending

    @staticmethod
    def check_name(number, name):
        if len(name) > MAX_NAME:
            raise Refused(number, f"{name}: at most {MAX_NAME} characters")

    def check_tests(self):
        """What only the whole file shows."""
        case = self.options.get("testcase")
        parameter = self.options.get("testparameter")
        if not self.tests:
            raise Refused(0, "the file has no @test")
        if parameter and not (case and "constructor" in case):
            raise Refused(parameter["line"], "@testParameter needs @testCase(constructor=...)")
        if case and ("before" in self.fixtures or "after" in self.fixtures):
            raise Refused(case["line"], "@before and @after do not go with @testCase: use setUp")
        if case and "testParameters" in case and not parameter:
            raise Refused(case["line"], "testParameters need a @testParameter type")
        for test in self.tests:
            given = [key for key in ("cases", "testParameters") if key in test]
            given += ["testParameters of @testCase"] if case and "testParameters" in case else []
            if bool(test["argument"]) != bool(case):
                raise Refused(test["line"], "a test takes (this) with @testCase, else ()")
            if case and "disabled" in test:
                raise Refused(test["line"], "@disable is for plain tests")
            if len(given) != (1 if parameter else 0):
                raise Refused(test["line"], "parameters come from exactly one of cases and "
                              "testParameters, and only with @testParameter")
            if "cases" in test and "constructor" not in parameter:
                raise Refused(test["line"], "cases need @testParameter(constructor=...)")

    def suite(self):
        """The subroutine that runs all tests of the file."""
        case, parameter = self.fixtures.get("testcase"), self.fixtures.get("testparameter")
        out = ["", f"subroutine {self.name}_suite()", "   use funit", f"   use {self.name}",
               "   implicit none"]
        if case:
            out.append(f"   type({case}), allocatable :: fixture")
        if parameter:
            out += [f"   type({parameter}), allocatable :: parameters(:)", "   integer :: i"]
        for test in self.tests:
            name, constructor = test["name"], self.options.get("testcase", {}).get("constructor")
            if "disabled" in test:
                out.append(f"   call skip_test('{name}')")
            elif parameter:
                expression = test.get("testParameters",
                                      self.options["testcase"].get("testParameters"))
                if "cases" in test:
                    make = self.options["testparameter"]["constructor"]
                    expression = "[" + ", ".join(
                        f"{make}({each})" for each in split_arguments(test["cases"][1:-1])) + "]"
                out += [f"   parameters = {expression}", "   do i = 1, size(parameters)"]
                out += self.fixture_test(f"'{name}['//parameters(i)%toString()//']'", name,
                                         f"{constructor}(parameters(i))")
                out.append("   end do")
            elif case:
                out += self.fixture_test(f"'{name}'", name, constructor and f"{constructor}()")
            else:
                before, after = self.fixtures.get("before"), self.fixtures.get("after")
                out += [f"   call start_test('{name}')"]
                out += [f"   call {before}()"] if before else []
                out += ["   if (.not. anyExceptions()) then", f"      call {name}()"]
                out += [f"      call {after}()"] if after else []
                out += ["   end if", "   call end_test()"]
        return out + [f"end subroutine {self.name}_suite"]

    @staticmethod
    def fixture_test(label, name, made_by):
        """A test on a fresh fixture object."""
        return [f"   call start_test({label})", "   if (allocated(fixture)) deallocate (fixture)",
                f"   fixture = {made_by}" if made_by else "   allocate (fixture)",
                "   call fixture%setUp()", "   if (.not. anyExceptions()) then",
                f"      call {name}(fixture)", "      call fixture%tearDown()", "   end if",
                "   call end_test()"]


def main(source, target):
    translator = Translator(source)
    try:
        text = translator.run()
    except Refused as refusal:
        sys.exit(f"{source}:{refusal.line}: error: {refusal}")
    Path(target).write_text(f'#line 1 "{source}"\n{text}', encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])

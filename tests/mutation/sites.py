"""Where a translation unit can be mutated, found in clang's syntax tree, and the text that holds all of its mutants at once.

A mutant is a number. The rewritten text asks at each site whether its number is the active one (mutant.hpp), so that one compilation serves
every mutant. Nothing of it shows in the type of an expression, and what is computed at compile time is left as it is.
"""
import bisect
import re
from dataclasses import dataclass

import clang.cindex as clang

# What becomes of each operator; the C++ names are those of mutant.hpp.
BINARY = {
    "<": ("less", "<="), "<=": ("less_equal", "<"), ">": ("greater", ">="), ">=": ("greater_equal", ">"), "==": ("equal", "!="),
    "!=": ("not_equal", "=="), "+": ("plus", "-"), "-": ("minus", "+"), "*": ("times", "/"), "/": ("over", "*"), "%": ("modulo", "*"),
    "&": ("bit_and", "|"), "|": ("bit_or", "&"), "^": ("bit_xor", "&"), "<<": ("shift_left", ">>"), ">>": ("shift_right", "<<"),
    "+=": ("add", "-="), "-=": ("subtract", "+="), "|=": ("include", "&="), "^=": ("toggle", "|="),
}
COMPARISONS = {"<", "<=", ">", ">=", "==", "!="}
NEEDED_BY_COMPILER = {"kNoHex"}  # another constant is made of it
LITERAL = re.compile(r"(\d[\w.'+-]*|'(\\.|[^'])'|true|false)$")
K = clang.CursorKind


@dataclass
class Mutant:
    number: int
    file: str
    line: int
    column: int
    source: str  # the line's text
    change: str  # "< becomes <="

    def identity(self):
        """Its place, for one state of the file."""
        return f"{self.file}:{self.line}:{self.column}:{self.change.split(' #')[0]}"

    def key(self):
        """Its line's text, which stays the same when lines are added above."""
        return f"{self.file} | {self.source} | {self.change}"


class Rewriter:
    """One file: sites in, text with every mutant out."""

    def __init__(self, path, name, mutants):
        self.text = path.read_text()
        self.name = name
        self.mutants = mutants
        self.starts = [0] + [i + 1 for i, c in enumerate(self.text) if c == "\n"]
        self.seen = set()
        self.edits = []  # (offset, order, text, length replaced)

    def add(self, at, change):
        line = bisect.bisect_right(self.starts, at)
        source = self.text[self.starts[line - 1]:].split("\n", 1)[0].strip()
        same = sum(m.file == self.name and m.source == source and m.change.split(" #")[0] == change for m in self.mutants)
        column = at - self.starts[line - 1] + 1
        self.mutants.append(Mutant(len(self.mutants) + 1, self.name, line, column, source, change + (f" #{same + 1}" if same else "")))
        return len(self.mutants)

    def wrap(self, start, end, before, after):
        # At one place the wider wrap opens first and closes last.
        self.edits.append((start, 1, -end, before, 0))
        self.edits.append((end, 0, -start, after, 0))

    def replace(self, start, end, by):
        self.edits.append((start, 2, 0, by, end - start))

    def once(self, what, start, end):
        new = (what, start, end) not in self.seen
        self.seen.add((what, start, end))
        return new

    def binary(self, left, right, whole):
        start, end = whole
        between = self.text[left:right]
        operator = re.sub(r"/\*.*?\*/|//[^\n]*", "", between, flags=re.S).strip()
        if operator in ("&&", "||"):
            if self.once("logical", start, end):
                at = left + between.index(operator)
                number = self.add(at, f"{operator} becomes {'||' if operator == '&&' else '&&'}")
                flip = f"mutant::flip<{number}>("
                self.wrap(start, end, flip, ")")
                self.wrap(start, at, flip, ")")
                self.wrap(at + 2, end, flip, ")")
            return
        if operator not in BINARY or not self.once("binary", start, end):
            return
        function, becomes = BINARY[operator]
        at = left + between.index(operator)
        changes = [f"{operator} becomes {becomes}"]
        if operator in COMPARISONS - {"==", "!="}:
            changes.append(f"{operator} is negated")
        numbers = [self.add(at, change) for change in changes]
        self.wrap(start, end, f"mutant::{function}<{numbers[0]}>(", ")")
        self.replace(at, at + len(operator), ", ")

    def at_run_time(self, start, end):
        """A number of the program that the compiler knows is initialised when the program starts, to be a site."""
        declaration = re.match(r"constexpr ((?:float|double|std::u?int\d+_t|std::size_t) (k\w+) =\s)", self.text[start:end])
        if declaration and declaration[2] not in NEEDED_BY_COMPILER and self.once("run time", start, end):
            self.replace(start, start + len("constexpr"), "const")
            self.wrap(start + declaration.end(), end, "mutant::at_start(", ")")

    def condition(self, start, end):
        if self.once("condition", start, end):
            self.wrap(start, end, f"mutant::flip<{self.add(start, 'condition is negated')}>(", ")")

    def negation(self, start, end):
        if self.once("negation", start, end):
            self.wrap(start, end, f"mutant::flip<{self.add(start, '! is dropped')}>(", ")")

    def literal(self, start, end):
        text = self.text[start:end]
        if LITERAL.match(text) and self.once("literal", start, end):
            self.wrap(start, end, f"mutant::constant<{self.add(start, f'{text} is another')}>(", ")")

    def step(self, start, end):
        text = self.text[start:end]
        operator = text[:2] if text[:2] in ("++", "--") else text[-2:]
        if self.once("step", start, end):
            number = self.add(start, f"{operator} becomes {'--' if operator == '++' else '++'}")
            prefix = text.startswith(operator)
            self.wrap(start, end, f"mutant::{'step' if prefix else 'step_after'}<{number}, {1 if operator == '++' else -1}>(", ")")
            at = start if prefix else end - 2
            self.replace(at, at + 2, "")

    def opposite(self, start, end):
        if self.once("opposite", start, end) and not LITERAL.match(self.text[start + 1:end]):
            self.wrap(start, end, f"mutant::opposite<{self.add(start, 'unary - is dropped')}>(", ")")
            self.replace(start, start + 1, "")

    def assignment(self, start, end):
        if self.once("assignment", start, end):
            self.wrap(start, end, f"(mutant::on({self.add(start, 'assignment is left out')}) ? void() : void(", "))")

    def returned(self, start, end, nothing):
        semicolon = self.text.index(";", end)
        if self.once("return", start, end):
            number = self.add(start, "returns a value of nothing")
            self.wrap(start, semicolon + 1, f"{{ if (mutant::on({number})) return {nothing}; ", " }")

    def rewritten(self):
        out, at = [], 0
        for offset, _, _, text, replaced in sorted(self.edits, key=lambda e: (e[0], e[1], e[2])):
            out.append(self.text[at:offset])
            out.append(text)
            at = max(at, offset) + replaced
        return '#include "tests/mutation/mutant.hpp"\n' + "".join(out) + self.text[at:]


STATEMENT_PARENTS = {K.COMPOUND_STMT, K.CASE_STMT, K.DEFAULT_STMT}
FUNCTIONS = {K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.LAMBDA_EXPR, K.CONVERSION_FUNCTION, K.FUNCTION_TEMPLATE}
UNTOUCHED = {K.STATIC_ASSERT, K.ENUM_CONSTANT_DECL, K.USING_DECLARATION}


def kind_of(cursor):
    """None for kinds that the Python binding does not know, like C++20's."""
    try:
        return cursor.kind
    except ValueError:
        return None


def extent(cursor):
    return cursor.extent.start.offset, cursor.extent.end.offset


def visit(cursor, parents, files):
    """Records every site below `cursor`; `files`: path -> Rewriter."""
    where = cursor.extent.start.file
    rewriter = files.get(where.name) if where else None
    if where and not rewriter:
        return  # a header of the library or of another room
    children = list(cursor.get_children())
    kind = kind_of(cursor)
    if kind in UNTOUCHED:
        return
    if rewriter:
        record(cursor, children, parents, rewriter)
        if kind == K.VAR_DECL and rewriter.name.endswith(".cpp"):
            rewriter.at_run_time(*extent(cursor))
    declared = kind in (K.VAR_DECL, K.FIELD_DECL, K.PARM_DECL)
    for i, child in enumerate(children):
        if declared and child.extent.end.offset <= cursor.location.offset:
            continue  # the type: numbers in it are computed at compile time
        if kind == K.CASE_STMT and i == 0:
            continue
        visit(child, [cursor] + parents[:40], files)


def is_statement(cursor, parents):
    at = next((p for p in parents if kind_of(p) not in (K.UNEXPOSED_EXPR, None)), None)
    if at is None:
        return False
    if kind_of(at) in STATEMENT_PARENTS:
        return True
    if kind_of(at) == K.IF_STMT:  # a branch, not the condition
        return extent(list(at.get_children())[0]) != extent(cursor) and at.extent.start.offset < cursor.extent.start.offset
    return False


def record(cursor, children, parents, r):
    start, end = extent(cursor)
    kind = kind_of(cursor)
    if kind in (K.BINARY_OPERATOR, K.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
        left, right = children[0].extent.end.offset, children[1].extent.start.offset
        if r.text[left:right].strip() == "=":
            if is_statement(cursor, parents):
                r.assignment(start, end)
        else:
            r.binary(left, right, (start, end))
    elif kind == K.CALL_EXPR and len(children) == 3 and children[1].spelling.startswith("operator"):
        left, right = children[0].extent.end.offset, children[2].extent.start.offset
        if r.text[left:right].strip() == "=":
            if is_statement(cursor, parents):
                r.assignment(start, end)
        elif children[0].extent.start.offset == start:
            r.binary(left, right, (start, end))
    elif kind == K.UNARY_OPERATOR:
        text = r.text[start:end]
        if text.startswith("++") or text.endswith("++") or text.startswith("--") or text.endswith("--"):
            r.step(start, end)
        elif text.startswith("!") and not text.startswith("!="):
            r.negation(start, end)
        elif text.startswith("-"):
            r.opposite(start, end)
    elif kind in (K.INTEGER_LITERAL, K.FLOATING_LITERAL, K.CXX_BOOL_LITERAL_EXPR, K.CHARACTER_LITERAL):
        r.literal(start, end)
    elif kind in (K.IF_STMT, K.WHILE_STMT, K.CONDITIONAL_OPERATOR) and children:
        condition = next((c for c in children if kind_of(c) != K.DECL_STMT), None)
        if condition is children[0] and kind_of(condition) != K.VAR_DECL:
            a, b = extent(condition)
            if kind == K.CONDITIONAL_OPERATOR and "?" not in r.text[b:end]:
                return  # inside of a macro
            if re.fullmatch(r"[\w.:>()\[\]-]+(\([^()]*\))?", r.text[a:b]) and "=" not in r.text[a:b]:
                r.condition(a, b)
    elif kind == K.RETURN_STMT and r.text.startswith("return", start) and children and not r.text[children[0].extent.start.offset] == "{":
        function = next((p for p in parents if kind_of(p) in FUNCTIONS), None)
        if function is not None and kind_of(function) in (K.FUNCTION_DECL, K.CXX_METHOD):
            result = function.result_type.get_canonical().kind
            if result not in (clang.TypeKind.VOID, clang.TypeKind.LVALUEREFERENCE) and not LITERAL.match(
                    r.text[children[0].extent.start.offset:children[0].extent.end.offset]):
                standard = "std::" in function.result_type.get_canonical().spelling
                r.returned(start, end, "{}" if standard else "mutant::Nothing{}")

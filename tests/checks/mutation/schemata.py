#!/usr/bin/python3
"""Mutant schemata: one copy of a file with all of its mutants, selected by number at run time.

A mutant is one change that a typing error could make: a comparison off by one, an operand left
out, a sign, a number, a condition that is always or never true, a statement left out. `a < b && c`
becomes

    (::bess_mutant(4) ? (c) : ::bess_mutant(5) ? (a < b)
                            : ((::bess_mutant(3) ? (a <= b) : (a < b)) && c))

so that hundreds of mutants are one compilation (mutant schemata: Untch, Offutt, Harrold 1993).
libclang gives the extent of an expression. Expressions that are evaluated at compile time are left
unchanged: constants, default values, template arguments, static_assert.
"""
import bisect
import re
import sys
from dataclasses import dataclass, field

from clang.cindex import CursorKind, Index, StorageClass, TypeKind  # noqa: F401

EXPRESSIONS = {
    "<": ["<="], "<=": ["<"], ">": [">="], ">=": [">"], "==": ["!="], "!=": ["=="],
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["/"],
    "&": ["|"], "|": ["&"], "<<": [">>"], ">>": ["<<"],
}
COMPOUND = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=",
            "<<=": ">>=", ">>=": "<<=", "^=": "|="}
NOT_AT_RUN_TIME = {
    CursorKind.STATIC_ASSERT, CursorKind.ENUM_DECL, CursorKind.TEMPLATE_NON_TYPE_PARAMETER,
    CursorKind.TEMPLATE_TYPE_PARAMETER, CursorKind.USING_DECLARATION, CursorKind.TYPE_ALIAS_DECL,
    CursorKind.TYPEDEF_DECL, CursorKind.CONCEPT_DECL if hasattr(CursorKind, "CONCEPT_DECL")
            else None,
}
FUNCTIONS = {CursorKind.FUNCTION_DECL, CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR,
             CursorKind.DESTRUCTOR, CursorKind.FUNCTION_TEMPLATE, CursorKind.CONVERSION_FUNCTION}


@dataclass
class Node:
    """A piece of the text, and its replacement in each mutant."""
    start: int
    end: int
    function: str
    alternatives: list  # (old, new, text)
    cast: str = ""      # cast to one type, where the alternatives have several
    children: list = field(default_factory=list)


def one_line(text):
    text = re.sub(r"//[^\n]*", "", text)
    return " ".join(text.split())


class File:
    def __init__(self, path, arguments):
        self.path = path
        with open(path, "rb") as f:
            self.raw = f.read()
        if any(b > 127 for b in self.raw):
            self.raw = re.sub(rb"[^\x00-\x7f]", b"?", self.raw)  # in comments only
        self.text = self.raw.decode()
        self.nodes = []
        unit = Index.create().parse(path, arguments)
        self.errors = [str(d) for d in unit.diagnostics if d.severity >= 3]
        for cursor in unit.cursor.get_children():
            if cursor.location.file and cursor.location.file.name == path:
                self.walk(cursor, [], "")

    def at(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def source(self, start, end):
        return self.text[start:end]

    def add(self, start, end, function, alternatives, cast=""):
        if alternatives:
            self.nodes.append(Node(start, end, function, alternatives, cast))

    # --- which pieces ---
    def walk(self, cursor, parents, function):
        kind = cursor.kind
        if kind in NOT_AT_RUN_TIME or kind == CursorKind.FIELD_DECL:
            return
        if kind == CursorKind.StmtExpr:  # of a macro of the C library
            return
        start, end = self.at(cursor)
        if kind in FUNCTIONS:
            function = cursor.spelling.split("<")[0]
            if re.search(r"\bconsteval\b|= *default *;|= *delete *;", self.source(start,
                    end)[:400]):
                return
        if kind == CursorKind.VAR_DECL and re.search(r"\b(constexpr|static|thread_local)\b",
                                                     self.source(start, end).split("=")[0]):
            return
        if kind == CursorKind.PARM_DECL or (kind == CursorKind.VAR_DECL and not function):
            return
        children = list(cursor.get_children())
        self.look_at(cursor, kind, start, end, children, parents, function)
        for child in children:
            if kind == CursorKind.CASE_STMT and child == children[0]:
                continue
            self.walk(child, parents + [cursor], function)

    def look_at(self, cursor, kind, start, end, children, parents, function):
        if not function or start >= end or self.is_made_by_macro(children, start, end):
            return
        if kind == CursorKind.BINARY_OPERATOR and len(children) == 2:
            self.binary(start, end, children, function)
        elif kind == CursorKind.COMPOUND_ASSIGNMENT_OPERATOR and len(children) == 2:
            self.compound(start, end, children, function)
        elif kind == CursorKind.UNARY_OPERATOR and len(children) == 1:
            self.unary(start, end, children[0], function)
        elif kind == CursorKind.INTEGER_LITERAL:
            self.literal(cursor, start, end, parents, function)
        elif kind in (CursorKind.IF_STMT, CursorKind.WHILE_STMT):
            self.condition(kind, start, children, function)
        elif kind == CursorKind.CONDITIONAL_OPERATOR and len(children) == 3:
            self.conditional(start, end, children, function)
        elif kind == CursorKind.RETURN_STMT and len(children) == 1:
            self.returned(children[0], function)
        if parents:
            self.statement(cursor, kind, start, end, parents[-1], function)

    def is_made_by_macro(self, children, start, end):
        """libclang then reports the position of the macro, or only half of the expression."""
        at = [self.at(c) for c in children]
        return any(s < start or e > end for s, e in at) or self.source(start,
                end).startswith("cJSON_ArrayForEach")

    def operator_between(self, left, right):
        between = re.sub(r"//[^\n]*", "", self.source(left[1], right[0])).strip()
        return between

    def binary(self, start, end, children, function):
        left, right = self.at(children[0]), self.at(children[1])
        op = self.operator_between(left, right)
        a, b = self.source(*left), self.source(*right)
        was = one_line(self.source(start, end))
        if op in ("&&", "||"):
            self.add(start, end, function, [(was, one_line(b), f"static_cast<bool>({b})"),
                                            (was, one_line(a), f"static_cast<bool>({a})")])
        elif op in EXPRESSIONS and TypeKind.POINTER not in (children[0].type.kind,
                children[1].type.kind):
            self.add(start, end, function,
                     [(was, one_line(f"{a} {o} {b}"), f"({a} {o} {b})") for o in EXPRESSIONS[op]])

    def compound(self, start, end, children, function):
        left, right = self.at(children[0]), self.at(children[1])
        op = self.operator_between(left, right)
        if op in COMPOUND and children[0].type.kind != TypeKind.POINTER:
            a, b = self.source(*left), self.source(*right)
            text = f"{a} {COMPOUND[op]} {b}"
            self.add(start, end, function, [(one_line(self.source(start, end)), one_line(text),
                    f"({text})")])

    def unary(self, start, end, child, function):
        text = self.source(start, end)
        inner = self.source(*self.at(child))
        if text.startswith(("++", "--")) and child.type.kind != TypeKind.POINTER:
            other = ("--" if text.startswith("++") else "++") + inner
            self.add(start, end, function, [(one_line(text), one_line(other), f"({other})")])
        elif text[:1] == "-" and not text.startswith("--"):
            self.add(start, end, function, [(one_line(text), one_line(inner), f"({inner})")])
        elif text[:1] == "!":
            self.add(start, end, function, [(one_line(text), one_line(inner),
                    f"static_cast<bool>({inner})")])

    def literal(self, cursor, start, end, parents, function):
        text = self.source(start, end)
        if not re.fullmatch(r"(0[xX][0-9a-fA-F']+|[0-9][0-9']*)([uUlL]*)", text):
            return
        before = self.text[:start].rstrip()[-1:]
        after = self.text[end:].lstrip()[:1]
        if (before in "<,[" and after in ">]") or before == "<" and after == ",":
            return  # of a type
        if parents and parents[-1].type.kind == TypeKind.POINTER:
            return
        number = re.match(r"0[xX][0-9a-fA-F']+|[0-9][0-9']*", text).group()
        value = int(number.replace("'", ""), 16 if number[:2] in ("0x", "0X") else 10)
        other = f"{value + 1}{text[len(number):]}"
        context = one_line(self.text[max(0,
                start - 24):start] + "[" + text + "]" + self.text[end:end + 16])
        self.add(start, end, function, [(context, other, other)])

    def condition(self, kind, start, children, function):
        if not children:
            return
        first = children[0]
        if first.kind in (CursorKind.VAR_DECL, CursorKind.DECL_STMT):
            return
        head = self.text[start:self.at(first)[0]]
        if re.search(r"constexpr|;", head):
            return
        s, e = self.at(first)
        text = self.source(s, e)
        if self.text[e:].lstrip()[:1] != ")":
            return  # libclang lost its end
        alternatives = [(f"if ({one_line(text)})", "false", "false")]
        if kind == CursorKind.IF_STMT:
            alternatives.append((f"if ({one_line(text)})", "true", "true"))
        self.add(s, e, function, alternatives, "bool")

    def conditional(self, start, end, children, function):
        s, e = self.at(children[0])
        text = self.source(s, e)
        whole = one_line(self.source(start, end))
        self.add(s, e, function, [(f"{one_line(text)} ? in {whole}", "true", "true"),
                                  (f"{one_line(text)} ? in {whole}", "false", "false")],
                 "bool")

    def returned(self, child, function):
        s, e = self.at(child)
        text = self.source(s, e)
        if child.type.kind == TypeKind.BOOL and text not in ("true", "false"):
            self.add(s, e, function, [(f"return {one_line(text)}", "true", "true"),
                                      (f"return {one_line(text)}", "false", "false")],
                     "bool")
        elif text in ("true", "false"):
            other = "false" if text == "true" else "true"
            self.add(s, e, function, [(f"return {text}", other, other)])

    def statement(self, cursor, kind, start, end, parent, function):
        if not (kind.is_expression()
                or kind == CursorKind.UNEXPOSED_EXPR) or not self.is_statement(parent, cursor):
            return
        text = self.source(start, end)
        if self.text[end:].lstrip()[:1] != ";" or re.match(
                r"(return|delete|throw|static_assert|assert)\b", text):
            return
        if re.match(r"static_cast<void>\(\w+\)$", text):
            return
        self.add(start, end, function, [(one_line(text) + ";", "(left out)", "0")],
                 "void")

    @staticmethod
    def is_statement(parent, cursor):
        if parent.kind == CursorKind.COMPOUND_STMT:
            return True
        if parent.kind in (CursorKind.IF_STMT, CursorKind.FOR_STMT, CursorKind.WHILE_STMT,
                           CursorKind.CXX_FOR_RANGE_STMT):
            children = list(parent.get_children())
            # The parts of the head are identified by text: a statement ends in a semicolon, and the
            # first child of `if` and `while` is the condition.
            if parent.kind in (CursorKind.FOR_STMT, CursorKind.CXX_FOR_RANGE_STMT):
                return cursor == children[-1]
            return cursor != children[0]
        return False

    # --- one tree, one text ---
    def tree(self):
        """Nested pieces; a piece that overlaps another is left out."""
        self.nodes.sort(key=lambda n: (n.start, -n.end))
        roots, stack = [], []
        for node in self.nodes:
            while stack and stack[-1].end <= node.start:
                stack.pop()
            if stack and node.end > stack[-1].end:
                continue
            if stack and (node.start, node.end) == (stack[-1].start, stack[-1].end):
                stack[-1].alternatives += node.alternatives  # the same piece twice: one node
                stack[-1].cast = stack[-1].cast or node.cast
                continue
            (stack[-1].children if stack else roots).append(node)
            stack.append(node)
        return roots


def render(file, nodes, start, end, number):
    """The text from start to end, its pieces replaced; number() is None for what is left out."""
    out, at = [], start
    for node in nodes:
        out.append(file.source(at, node.start))
        inner = render(file, node.children, node.start, node.end, number)
        chosen = []
        for alternative in node.alternatives:
            n = number(file, node, alternative)
            if n is not None:
                chosen.append(f"::bess_mutant({n}) ? {cast(node, alternative[2])} : ")
        out.append("(" + "".join(chosen) + cast(node, inner) + ")" if chosen else inner)
        at = node.end
    out.append(file.source(at, end))
    return "".join(out)


def cast(node, text):
    return f"static_cast<{node.cast}>({text})" if node.cast else f"({text})"


def line_of(file, offset):
    if not hasattr(file, "lines"):
        file.lines = [0] + [m.end() for m in re.finditer("\n", file.text)]
    return bisect.bisect_right(file.lines, offset)


if __name__ == "__main__":
    sys.exit("a part of tests/checks/mutation/mutate.py")

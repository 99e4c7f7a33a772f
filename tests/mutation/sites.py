"""Where the C++ can be mutated, and how: found in the syntax trees that tree-sitter makes.

A :class:`Mutant` is what a part of an expression, or a statement, is replaced with. What must be
known while compiling (template arguments, array sizes, ``constexpr``, preprocessor lines) is left
alone, since all mutants are compiled into one program (``schemata.py``).
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tree_sitter_cpp
from tree_sitter import Language, Node, Parser

PARSER = Parser(Language(tree_sitter_cpp.language()))
# words that only the compiler's optimization needs and the grammar does not know
DECORATION = re.compile(rb"SPHCLOTH_(?:INLINE|MULTIVERSION|LAMBDA)\b|__attribute__\(\(.*?\)\)")
# what is not compiled for a single target
OTHER_TARGETS = "SPHCLOTH_X86_TARGETS"

FAULT = "fault"  # in the place of an operator: one of the past
# in a template, the bytes of an operand
HOLE = re.compile("\0(\\d+):(\\d+)\0")

OPERATORS = {
    "arithmetic": {"+": "-", "-": "+", "*": "/", "/": "*"},
    "assignment": {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="},
    "comparison": {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    "logic": {"&&": "||", "||": "&&"},
}
EXTREMA = {"std::min": "std::max", "std::max": "std::min"}
COMPILE_TIME = {
    "template_argument_list",
    "template_parameter_list",
    "static_assert_declaration",
    "enumerator",
    "alias_declaration",
    "alignas_qualifier",
    "noexcept",
    "decltype",
    "bitfield_clause",
    "preproc_def",
    "preproc_call",
    "preproc_include",
    "ERROR",
}


@dataclass(frozen=True)
class Mutant:
    """The bytes ``start:end`` of a file, and two ways to write them, of which one is right.

    Operands are offsets in both, so that mutants may lie in each other.
    """

    file: str
    start: int
    end: int
    line: int
    operator: str
    right: str
    wrong: str
    statement: bool = False

    @property
    def folder(self) -> str:
        """Return the folder of the sources, with its part of ``core``."""
        return str(Path(self.file).parent)

    def readable(self, template: str, text: bytes) -> str:
        """Return one of the two ways to write it, with operands, in a line."""
        filled = HOLE.sub(lambda hole: text[int(hole[1]) : int(hole[2])].decode(), template)
        return " ".join(filled.split())


def mutants_of(file: str, text: bytes) -> list[Mutant]:
    """Return all mutants of a file, in the order of their places."""
    plain = DECORATION.sub(lambda found: b" " * len(found[0]), text)
    return list(_below(file, PARSER.parse(plain).root_node))


def drawn(file: str, text: bytes, seed: int) -> list[Mutant]:
    """Return one mutant of each place of a file, in an order that the seed decides."""
    by_place: dict[tuple[int, int, str], list[Mutant]] = {}
    for mutant in mutants_of(file, text):
        by_place.setdefault((mutant.start, mutant.end, mutant.operator), []).append(mutant)
    dice = random.Random(f"{seed} {file}")
    chosen = [dice.choice(of_place) for of_place in by_place.values()]
    dice.shuffle(chosen)
    return chosen


def hole(start: int, end: int) -> str:
    """Return what stands in a template for the bytes of an operand."""
    return f"\0{start}:{end}\0"


def _hole(node: Node) -> str:
    return hole(node.start_byte, node.end_byte)


def _below(file: str, node: Node) -> Iterator[Mutant]:
    for operator, right, wrong in _choices(node):
        statement = node.type == "expression_statement"
        line = node.start_point[0] + 1
        yield Mutant(file, node.start_byte, node.end_byte, line, operator, right, wrong, statement)
    for child in node.children:
        if not _known_while_compiling(node, child):
            yield from _below(file, child)


def _known_while_compiling(parent: Node, child: Node) -> bool:
    if child.type in COMPILE_TIME or _is_constexpr(child):
        return True
    if parent.type == "array_declarator":
        return child == parent.child_by_field_name("size")
    if parent.type == "case_statement":
        return child == parent.child_by_field_name("value")
    if parent.type.startswith("preproc_if") or parent.type == "preproc_elif":
        condition = parent.child_by_field_name("condition")
        name = parent.child_by_field_name("name")
        other = name is not None and name.text.decode() == OTHER_TARGETS
        return child == condition or (other and child.type != "preproc_else")
    # the head of a loop that is told to be of one form
    return parent.type == "for_statement" and _follows_pragma(parent) and child.type not in BODIES


BODIES = ("compound_statement", "expression_statement")


def _is_constexpr(node: Node) -> bool:
    words = [one.text for one in node.children if one.type in ("type_qualifier", "constexpr")]
    if node.type == "if_statement":
        return False
    if node.type == "condition_clause":
        return node.parent is not None and node.parent.text.startswith(b"if constexpr")
    return b"constexpr" in words


def _follows_pragma(node: Node) -> bool:
    before = node.prev_sibling
    return before is not None and before.type == "preproc_call"


def _choices(node: Node) -> Iterator[tuple[str, str, str]]:
    """Yield operator, right and wrong code."""
    match node.type:
        case "binary_expression" | "assignment_expression":
            yield from _exchanged(node)
        case "unary_expression":
            yield from _without_sign(node)
        case "number_literal":
            yield from _other_numbers(node.text.decode())
        case "call_expression":
            yield from _other_extremum(node)
        case "expression_statement":
            yield from _left_out(node)


def _exchanged(node: Node) -> Iterator[tuple[str, str, str]]:
    left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
    sign = node.child_by_field_name("operator").text.decode()
    if _is_text(left) or _is_text(right):
        return
    for operator, exchange in OPERATORS.items():
        if sign in exchange:
            first, last = f"({_hole(left)})", f"({_hole(right)})"
            yield operator, f"{first} {sign} {last}", f"{first} {exchange[sign]} {last}"


def _is_text(node: Node) -> bool:
    words = (b'"', b"to_string", b"fmt::", b"std::string")
    return any(word in node.text for word in words)


def _without_sign(node: Node) -> Iterator[tuple[str, str, str]]:
    sign = node.child_by_field_name("operator").text.decode()
    argument = f"({_hole(node.child_by_field_name('argument'))})"
    if sign == "-":
        yield "negation", f"-{argument}", argument
    elif sign == "!":
        yield "negation", f"!{argument}", f"static_cast<bool>({argument})"


def _other_numbers(text: str) -> Iterator[tuple[str, str, str]]:
    try:
        value = float.fromhex(text) if text.startswith("0x") else float(text.strip("fFuUlL"))
    except ValueError:
        return
    for wrong, code in ((0.0, "0"), (1.0, "1"), (2 * value, f"2 * {text}")):
        if wrong != value:
            yield "constant", text, f"static_cast<decltype({text})>({code})"


def _other_extremum(node: Node) -> Iterator[tuple[str, str, str]]:
    name, arguments = node.child_by_field_name("function"), node.child_by_field_name("arguments")
    kind = re.match(r"std::m(?:in|ax)\b", name.text.decode())
    if kind:
        rest = name.text.decode()[kind.end() :]
        right, wrong = (f"{one}{rest}{_hole(arguments)}" for one in (kind[0], EXTREMA[kind[0]]))
        yield "extremum", right, wrong


def _left_out(node: Node) -> Iterator[tuple[str, str, str]]:
    inner = next((one for one in node.children if one.is_named), None)
    kinds = ("call_expression", "assignment_expression", "update_expression")
    if inner is not None and inner.type in kinds and not _follows_pragma(node):
        yield "removal", f"{_hole(inner)};", ""

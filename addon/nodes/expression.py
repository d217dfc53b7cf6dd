# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas as nodes: `w / (1.0 - c * r)` builds the nodes of a shader.

A node is added when its socket is first asked for, and stands in the frame in which the formula was written.
So a product within a sum becomes one node, Multiply Add, and a clamped result the option Clamp of its node:
Cycles pays for each node.
"""

from functools import partial

_NUMBERS = ("DOT_PRODUCT", "LENGTH")  # operations of vectors with a number as result


class Value:
    """A number or a vector in a node tree, here an output socket that exists.

    Operators and the functions below take values, numbers, and tuples of three numbers. With a vector, a
    number stands for a vector of equal parts. Comparisons give 1 or 0."""

    def __init__(self, graph, socket):
        self.graph, self.socket = graph, socket
        self.is_vector = socket.type in ("VECTOR", "RGBA")

    def named(self, label):
        """The same value. The node of a formula gets the label, and is not merged with that of a sum. The
        first label stays."""
        return self

    def __add__(self, other):
        return _sum(self, other)

    def __sub__(self, other):
        return _difference(self, other)

    def __rsub__(self, other):
        return _difference(other, self)

    def __mul__(self, other):
        return _product(self, other)

    def __truediv__(self, other):
        return _quotient(self, other)

    def __rtruediv__(self, other):
        return _quotient(other, self)

    def __pow__(self, power):
        return self * self if power == 2 else _Step("POWER", self, power)

    def __rpow__(self, base):
        return _Step("POWER", base, self)

    def __neg__(self):
        return self * -1.0

    def __abs__(self):
        return _Step("ABSOLUTE", self)

    def __lt__(self, other):
        return _Step("LESS_THAN", self, other)

    def __gt__(self, other):
        return _Step("GREATER_THAN", self, other)

    def __bool__(self):
        raise TypeError("a value is known in the render only; a comparison is the number 1 or 0")

    __radd__, __rmul__ = __add__, __mul__


class _Step(Value):
    """The result of a node that may not be there yet: an operation of Blender's Math nodes."""

    def __init__(self, operation, *operands, clamp=False):
        self.graph = next(one.graph for one in operands if isinstance(one, Value))
        self.operation, self.operands, self.clamp = operation, operands, clamp
        self._among_vectors = any(map(_is_vector, operands))
        self.is_vector = self._among_vectors and operation not in _NUMBERS
        self._label, self._frame, self._socket = "", self.graph.frame, None

    def named(self, label):
        self._label = self._label or label
        return self

    @property
    def is_open(self):
        """True while the operation may become part of another node."""
        return not (self._label or self.clamp or self._socket)

    @property
    def socket(self):
        if self._socket is None:
            self._socket = self._drawn()
        return self._socket

    def _drawn(self):
        graph = self.graph
        node = graph.node("ShaderNodeVectorMath" if self._among_vectors else "ShaderNodeMath", self._label)
        node.operation, node.parent = self.operation, self._frame
        if self.clamp:
            node.use_clamp = True
        targets = (node.inputs[0], node.inputs["Scale"]) if self.operation == "SCALE" else node.inputs
        for target, operand in zip(targets, self.operands, strict=False):
            is_plain = target.type == "VECTOR" and isinstance(operand, int | float)
            graph.set(target, (operand,) * 3 if is_plain else operand)
        return node.outputs["Value" if not self.is_vector else "Vector"]


def clamped(value):
    """The number, at least 0 and at most 1."""
    if not isinstance(value, Value):
        return min(max(value, 0.0), 1.0)
    if isinstance(value, _Step) and value.is_open:
        return _Step(value.operation, *value.operands, clamp=True)
    return _Step("ADD", value, 0.0, clamp=True)


minimum, maximum = partial(_Step, "MINIMUM"), partial(_Step, "MAXIMUM")  # of two
floor, ceil, sign = partial(_Step, "FLOOR"), partial(_Step, "CEIL"), partial(_Step, "SIGN")
sqrt, exponential = partial(_Step, "SQRT"), partial(_Step, "EXPONENT")
logarithm = partial(_Step, "LOGARITHM")  # of a value, to a base
modulo, floored_modulo = partial(_Step, "MODULO"), partial(_Step, "FLOORED_MODULO")  # by a second value
ping_pong = partial(_Step, "PINGPONG")  # a triangle wave from 0 to a second value
sine, cosine = partial(_Step, "SINE"), partial(_Step, "COSINE")
arccosine, arctangent = partial(_Step, "ARCCOSINE"), partial(_Step, "ARCTAN2")  # the second of y and x
dot, cross = partial(_Step, "DOT_PRODUCT"), partial(_Step, "CROSS_PRODUCT")
length, normalized = partial(_Step, "LENGTH"), partial(_Step, "NORMALIZE")
reflected = partial(_Step, "REFLECT")  # a vector, about a normal


def _is_vector(operand):
    return operand.is_vector if isinstance(operand, Value) else isinstance(operand, tuple)


def _is_open_product(operand):
    return isinstance(operand, _Step) and operand.operation == "MULTIPLY" and operand.is_open


def _negative(constant):
    return tuple(-part for part in constant) if isinstance(constant, tuple) else -constant


def _sum(first, second):
    for product, rest in ((first, second), (second, first)):
        if rest == 0.0:
            return product
        if _is_open_product(product) and product.is_vector >= _is_vector(rest):
            return _Step("MULTIPLY_ADD", *product.operands, rest)
    return _Step("ADD", first, second)


def _difference(first, second):
    if not isinstance(second, Value):
        return _sum(first, _negative(second)) if _is_open_product(first) else _Step("SUBTRACT", first, second)
    if _is_open_product(second) and second.is_vector >= _is_vector(first):
        factor, constant = sorted(second.operands, key=lambda one: not isinstance(one, Value))
        if not isinstance(constant, Value):
            return _Step("MULTIPLY_ADD", factor, _negative(constant), first)
    return _Step("SUBTRACT", first, second)


def _product(first, second):
    if isinstance(first, Value) and isinstance(second, Value) and first.is_vector != second.is_vector:
        return _Step("SCALE", *((first, second) if first.is_vector else (second, first)))
    return _Step("MULTIPLY", first, second)


def _quotient(first, second):
    if _is_vector(first) and isinstance(second, Value) and not second.is_vector:
        return first * (1.0 / second)
    return _Step("DIVIDE", first, second)

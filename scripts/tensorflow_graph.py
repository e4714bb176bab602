# SPDX-License-Identifier: BSD-3-Clause
"""Edits a frozen TensorFlow graph so that OpenCV's dnn module reads it, without TensorFlow.

A GraphDef is a protocol buffer: field 1 repeats NodeDef {1 name, 2 op, 3 repeated input, 5 attr map}.
Nodes that stay as they are keep their bytes, so weights are never touched.
"""

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
GRAPH_NODE = 1
NODE_NAME, NODE_OP, NODE_INPUT, NODE_ATTR = 1, 2, 3, 5
DT_INT32 = 3


class GraphError(ValueError):
    """The bytes are no graph, or not one that this edit is for."""


def read_varint(data, at):
    """(value, next position) of the base-128 number at a position."""
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            raise GraphError("ends in the middle of a number")
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
    raise GraphError("has a number of more than ten bytes")


def write_varint(value):
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def read_fields(data):
    """(field number, value, the field's own bytes) of each field, in order. Value: int or bytes."""
    at = 0
    while at < len(data):
        start = at
        key, at = read_varint(data, at)
        number, wire_type = key >> 3, key & 7
        if number == 0:
            raise GraphError("has a field with number 0")
        if wire_type == VARINT:
            value, at = read_varint(data, at)
        elif wire_type in (FIXED64, FIXED32, BYTES):
            size = {FIXED64: 8, FIXED32: 4}.get(wire_type)
            if size is None:
                size, at = read_varint(data, at)
            value = data[at : at + size]
            at += size
            if len(value) != size:
                raise GraphError("ends in the middle of a field")
        else:
            raise GraphError(f"has a field of unknown kind {wire_type}")
        yield number, value, data[start:at]


def bytes_field(number, value):
    return write_varint(number << 3 | BYTES) + write_varint(len(value)) + value


def varint_field(number, value):
    return write_varint(number << 3 | VARINT) + write_varint(value)


def text(value):
    try:
        return value.decode("utf-8")
    except (UnicodeDecodeError, AttributeError) as error:
        raise GraphError("has a name that is no text") from error


class Node:
    """One operation of the graph."""

    def __init__(self, data):
        self.data = data
        self.name, self.op, self.inputs = "", "", []
        for number, value, _ in read_fields(data):
            if number == NODE_NAME:
                self.name = text(value)
            elif number == NODE_OP:
                self.op = text(value)
            elif number == NODE_INPUT:
                self.inputs.append(text(value))
        if not self.name or not self.op:
            raise GraphError("has a node without a name or an operation")

    def with_inputs(self, inputs):
        """The same node fed by others."""
        head, tail = [], []
        for number, _, raw in read_fields(self.data):
            if number != NODE_INPUT:
                (head if number < NODE_INPUT else tail).append(raw)
        new = [bytes_field(NODE_INPUT, name.encode()) for name in inputs]
        return Node(b"".join(head + new + tail))


def attribute(name, value):
    """One entry of a node's attr map; `value` is an AttrValue."""
    return bytes_field(NODE_ATTR, bytes_field(1, name.encode()) + bytes_field(2, value))


def int_constant(name, value):
    """A Const node holding one int32."""
    content = bytes_field(4, value.to_bytes(4, "little", signed=True))
    tensor = varint_field(1, DT_INT32) + bytes_field(2, b"") + content
    return Node(
        bytes_field(NODE_NAME, name.encode())
        + bytes_field(NODE_OP, b"Const")
        + attribute("dtype", varint_field(6, DT_INT32))
        + attribute("value", bytes_field(8, tensor))
    )


def source(name):
    """The node that an input comes from ("node:1" and "^node" name outputs and mere order)."""
    return name.lstrip("^").split(":")[0]


def ancestors(nodes, names):
    """The nodes that `names` are computed from, themselves included."""
    found, waiting = set(), [source(n) for n in names]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        if name not in nodes:
            raise GraphError(f"lacks the node {name}")
        found.add(name)
        waiting += [source(n) for n in nodes[name].inputs]
    return found


def make_readable_by_opencv(data, factor=2):
    """Replaces the computed size of the graph's one ResizeBilinear by two constants: OpenCV reads a
    resize with three inputs as a zoom by these factors. Nodes that only served the size go."""
    others, order, nodes = [], [], {}
    for number, value, raw in read_fields(data):
        if number != GRAPH_NODE:
            others.append(raw)
            continue
        node = Node(value)
        if node.name in nodes:
            raise GraphError(f"has two nodes called {node.name}")
        order.append(node.name)
        nodes[node.name] = node
    if not nodes:
        raise GraphError("has no nodes")
    resizes = [n for n in nodes.values() if n.op == "ResizeBilinear"]
    if len(resizes) != 1:
        raise GraphError(f"has {len(resizes)} ResizeBilinear nodes, expected one")
    resize = resizes[0]
    if len(resize.inputs) == 3:
        raise GraphError("has been edited before: its ResizeBilinear has three inputs")
    if len(resize.inputs) != 2:
        raise GraphError(f"its ResizeBilinear has {len(resize.inputs)} inputs, expected two")

    used = {source(i) for n in nodes.values() for i in n.inputs}
    outputs = [name for name in order if name not in used]
    image, size = resize.inputs
    constants = [int_constant(f"{resize.name}/{axis}", factor) for axis in ("zoom_y", "zoom_x")]
    only_for_size = ancestors(nodes, [size])
    nodes[resize.name] = resize.with_inputs([image] + [c.name for c in constants])
    for constant in constants:
        nodes[constant.name] = constant
    kept = ancestors(nodes, outputs)
    edited = []
    for name in order:
        if name == resize.name:
            edited += [bytes_field(GRAPH_NODE, c.data) for c in constants]
        if name in kept or name not in only_for_size:
            edited.append(bytes_field(GRAPH_NODE, nodes[name].data))
    return b"".join(edited + others)

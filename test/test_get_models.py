# SPDX-License-Identifier: BSD-3-Clause
"""scripts/get_models and the graph edit that it does."""
import functools
import hashlib
import http.server
import importlib.machinery
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCRIPT = ROOT / "scripts" / "get_models"
sys.path.insert(0, str(ROOT / "scripts"))
import tensorflow_graph as graph  # noqa: E402


def load_script():
    loader = importlib.machinery.SourceFileLoader("get_models", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("get_models", loader))
    loader.exec_module(module)
    return module


def node(name, op, *inputs):
    data = graph.bytes_field(graph.NODE_NAME, name.encode())
    data += graph.bytes_field(graph.NODE_OP, op.encode())
    data += b"".join(graph.bytes_field(graph.NODE_INPUT, i.encode()) for i in inputs)
    return graph.bytes_field(graph.GRAPH_NODE, data + graph.attribute("T", graph.varint_field(6, 1)))


SMALL_GRAPH = b"".join([
    node("image", "Placeholder"),
    node("features", "Relu", "image"),
    node("size/one", "Const"),
    node("shape", "Shape", "features"),
    node("size", "StridedSlice", "shape:0", "size/one"),
    node("upsample", "ResizeBilinear", "features", "size"),
    node("out", "Identity", "upsample", "^size/one"),
    graph.bytes_field(4, graph.varint_field(1, 27)),
])


def nodes_of(data):
    return {n.name: n for n in map(graph.Node, (v for f, v, _ in graph.read_fields(data) if f == 1))}


class GraphEdit(unittest.TestCase):
    def test_numbers_read_back(self):
        for value in (0, 1, 127, 128, 300, 1 << 32, (1 << 63) + 5):
            self.assertEqual(graph.read_varint(graph.write_varint(value), 0)[0], value)

    def test_resize_gets_two_constants_and_the_size_goes(self):
        edited = graph.make_readable_by_opencv(SMALL_GRAPH)
        nodes = nodes_of(edited)
        self.assertNotIn("shape", nodes)
        self.assertNotIn("size", nodes)
        self.assertIn("size/one", nodes, "something else still waits for it")
        image, *factors = nodes["upsample"].inputs
        self.assertEqual(image, "features")
        self.assertEqual([nodes[f].op for f in factors], ["Const", "Const"])
        self.assertLess(list(nodes).index(factors[0]), list(nodes).index("upsample"))

    def test_everything_else_keeps_its_bytes(self):
        before, after = nodes_of(SMALL_GRAPH), nodes_of(graph.make_readable_by_opencv(SMALL_GRAPH))
        for name in ("image", "features", "size/one", "out"):
            self.assertEqual(before[name].data, after[name].data)
        self.assertTrue(graph.make_readable_by_opencv(SMALL_GRAPH).endswith(SMALL_GRAPH[-4:]))

    def test_edited_graph_is_refused(self):
        with self.assertRaisesRegex(graph.GraphError, "edited before"):
            graph.make_readable_by_opencv(graph.make_readable_by_opencv(SMALL_GRAPH))

    def test_every_truncation_is_noticed_or_lacks_what_it_lost(self):
        whole = len(nodes_of(SMALL_GRAPH))
        for size in range(len(SMALL_GRAPH) - 4):
            try:
                nodes = nodes_of(SMALL_GRAPH[:size])
            except graph.GraphError:
                continue
            self.assertLess(len(nodes), whole, f"cut to {size} bytes")

    def test_other_files_are_refused(self):
        for data in (b"", b"<!DOCTYPE html><html></html>", bytes(range(256)), b"\xff" * 64):
            with self.assertRaises(graph.GraphError):
                graph.make_readable_by_opencv(data)


class Script(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def run_script(self, *arguments, **environment):
        return subprocess.run([sys.executable, str(SCRIPT), *map(str, arguments)], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              env={**os.environ, **environment})

    def test_lists_each_licence(self):
        listed = self.run_script("--output", self.path)
        self.assertEqual(listed.returncode, 0)
        for words in ("Apache-2.0", "non-commercial", "pose_iter_440000", "pose_iter_584000"):
            self.assertIn(words, listed.stdout)

    def test_a_closed_pipe_is_no_error(self):
        for arguments in ((), ("--help",)):
            reader, writer = os.pipe()
            os.close(reader)
            with os.fdopen(writer) as closed:
                done = subprocess.run([sys.executable, str(SCRIPT), *arguments], stdout=closed,
                                      stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.stderr, "", arguments)

    def test_wrong_file_is_not_kept(self):
        wrong = self.path / "wrong.pb"
        wrong.write_bytes(SMALL_GRAPH)
        target = self.path / "models"
        done = self.run_script("tf_pose_mobilenet_v2_small", "--from", wrong, "--output", target)
        self.assertEqual(done.returncode, 1)
        self.assertIn("sha256 is", done.stderr)
        self.assertIn(str(wrong), done.stderr)
        self.assertEqual(list(target.iterdir()), [])

    def test_own_checksum_is_taken_instead(self):
        own = self.path / "own.pb"
        own.write_bytes(SMALL_GRAPH)
        target = self.path / "models"
        done = self.run_script("tf_pose_mobilenet_v2_small", "--from", own, "--output", target,
                               "--sha256", hashlib.sha256(SMALL_GRAPH).hexdigest())
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Apache-2.0", done.stdout)
        edited = (target / "tf_pose_mobilenet_v2_small.opencv.pb").read_bytes()
        self.assertEqual(edited, graph.make_readable_by_opencv(SMALL_GRAPH))
        self.assertTrue((target / "tf_pose_mobilenet_v2_small.opencv.yaml").is_file())
        self.assertEqual(list(target.glob("*.part")), [])

    def test_without_network_the_error_names_a_remedy(self):
        nowhere = "http://127.0.0.1:9"
        done = self.run_script("tf_pose_mobilenet_v2_small", "--output", self.path / "models",
                               https_proxy=nowhere, http_proxy=nowhere, no_proxy="")
        self.assertEqual(done.returncode, 1)
        self.assertIn("cannot be fetched", done.stderr)
        self.assertIn("--from FILE", done.stderr)

    def test_unwritable_folder_is_named(self):
        blocked = self.path / "file"
        blocked.write_text("in the way")
        done = self.run_script("tf_pose_mobilenet_v2_small", "--output", blocked / "models")
        self.assertEqual(done.returncode, 1)
        self.assertIn(str(blocked), done.stderr)
        self.assertNotIn("Traceback", done.stderr)

    def test_unknown_name_lists_the_known(self):
        done = self.run_script("pose_net")
        self.assertEqual(done.returncode, 1)
        self.assertIn("tf_pose_mobilenet_v2_small", done.stderr)

    def test_missing_prototxt_is_named(self):
        weights = self.path / "pose_iter_440000.caffemodel"
        weights.write_bytes(b"weights")
        done = self.run_script("pose_iter_440000", "--from", weights, "--output", self.path / "m",
                               "--sha256", hashlib.sha256(b"weights").hexdigest())
        self.assertEqual(done.returncode, 1)
        self.assertIn("pose_deploy_linevec.prototxt: no such file", done.stderr)


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Download(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "served").mkdir()
        handler = functools.partial(QuietHandler, directory=str(self.path / "served"))
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.script = load_script()

    def file(self, name, checksum):
        port = self.server.server_address[1]
        return self.script.File(name, f"http://127.0.0.1:{port}/{name}", checksum)

    def test_fetched_file_is_checked_and_renamed(self):
        (self.path / "served" / "net.bin").write_bytes(b"weights")
        good = "md5:" + hashlib.md5(b"weights").hexdigest()
        self.script.obtain(self.file("net.bin", good), None, self.path / "net.bin")
        self.assertEqual((self.path / "net.bin").read_bytes(), b"weights")

    def test_other_content_leaves_the_old_file(self):
        (self.path / "served" / "net.bin").write_bytes(b"something else")
        (self.path / "net.bin").write_bytes(b"old")
        wanted = "sha256:" + hashlib.sha256(b"weights").hexdigest()
        with self.assertRaisesRegex(self.script.ModelError, "not kept"):
            self.script.obtain(self.file("net.bin", wanted), None, self.path / "net.bin")
        self.assertEqual((self.path / "net.bin").read_bytes(), b"old")
        self.assertFalse((self.path / "net.bin.part").exists())

    def test_missing_file_is_named(self):
        with self.assertRaisesRegex(self.script.ModelError, "gone.bin: cannot be fetched"):
            self.script.obtain(self.file("gone.bin", "md5:0"), None, self.path / "gone.bin")

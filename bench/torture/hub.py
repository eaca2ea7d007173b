"""Small Hugging Face hub on the loopback, so slow that a download can be killed in the middle of a file."""
import hashlib
import http.server
import json
import pathlib
import random
import struct
import threading
import time

NAME = "someone/model"
COMMIT = "0123456789abcdef0123456789abcdef01234567"
PIECE = 16384


def weights(size, seed):
    """Returns a .safetensors file of random bytes, in which a lost or repeated part changes the digest."""
    header = json.dumps({"noise": {"dtype": "U8", "shape": [size], "data_offsets": [0, size]}}).encode()
    return struct.pack("<Q", len(header)) + header + random.Random(seed).randbytes(size)


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def reply(self, body, status=200, headers=()):
        self.send_response(status)
        for name, value in (*headers, ("Content-Length", str(len(body)))):
            self.send_header(name, value)
        self.end_headers()
        for at in range(0, len(body), PIECE):
            if self.command == "HEAD":
                break
            self.wfile.write(body[at:at + PIECE])
            if len(body) > PIECE:
                time.sleep(self.server.pause)

    def do_HEAD(self):
        self.do_GET()

    def do_GET(self):
        try:
            self.answer()
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def answer(self):
        files = self.server.files
        if self.path.startswith(f"/api/models/{NAME}/revision/"):
            listing = {"sha": COMMIT, "siblings": [{"rfilename": name} for name in files]}
            self.reply(json.dumps(listing).encode(), headers=[("Content-Type", "application/json")])
            return
        name = self.path.removeprefix(f"/{NAME}/resolve/{COMMIT}/")
        if name not in files:
            self.reply(b"", 404)
            return
        body = files[name]
        if not name.endswith(".safetensors"):
            tag = hashlib.sha1(b"blob %d\0" % len(body) + body).hexdigest()
            self.reply(body, headers=[("ETag", f'"{tag}"')])
            return
        tag = ('ETag', f'"{hashlib.sha256(body).hexdigest()}"')
        tags = [tag, ("X-Linked-Etag", tag[1]), ("X-Linked-Size", str(len(body)))]
        begin = int(self.headers.get("Range", "bytes=0-").removeprefix("bytes=").rstrip("-") or 0)
        if begin == 0:
            self.reply(body, headers=tags)
        else:
            self.reply(body[begin:], 206, [*tags, ("Content-Range",
                                                   f"bytes {begin}-{len(body) - 1}/{len(body)}")])


class Hub:
    """The hub's server. prior: folder of the repository's files. pause: seconds between pieces of 16 KiB."""

    def __init__(self, prior, pause=0.004):
        prior = pathlib.Path(prior)
        self.files = {str(path.relative_to(prior)): path.read_bytes()
                      for path in prior.rglob("*") if path.is_file() and path.name != "prior.json"}
        for name in self.files:
            if name.endswith(".safetensors"):
                self.files[name] = weights(1_500_000, name)
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.server.handle_error = lambda *_: None  # clients are killed during downloads
        self.server.files, self.server.pause = self.files, pause
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.url = f"http://127.0.0.1:{self.server.server_port}"

    def close(self):
        self.server.shutdown()
        self.server.server_close()

"""Browser test of the studio behind a reverse proxy with a path prefix: a password, an edit and its events."""
import contextlib
import http.client
import http.server
import socket
import threading
import time

from studio_page import MUG, PATIENCE, Page, Server, check

PREFIX = "/team/studio/"
PASSWORD = "a long password"
# Headers that belong to one connection, which a proxy does not forward.
HOP_BY_HOP = {"connection", "keep-alive", "te", "trailer", "transfer-encoding", "upgrade", "host"}


class Proxy:
    """Reverse proxy that forwards requests under the prefix to a port of this machine.

    strays: paths of requests outside of the prefix. last_ids: header Last-Event-ID of each request for events.
    """

    def __init__(self):
        proxy = self
        self.target = 0
        self.strays, self.last_ids, self.streams = [], [], set()

        class Handler(http.server.BaseHTTPRequestHandler):
            def log_message(self, *_):
                pass

            def hand_on(self):
                proxy.hand_on(self)

            do_GET = do_POST = do_PATCH = do_DELETE = do_HEAD = hand_on

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.server.handle_error = lambda *_: None  # the browser may close a connection at any time
        self.address = f"http://127.0.0.1:{self.server.server_port}{PREFIX}"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def hand_on(self, asked):
        if not asked.path.startswith(PREFIX):
            self.strays.append(asked.path)
            asked.send_error(404)
            return
        is_stream = asked.path == PREFIX + "api/events"
        headers = {name: value for name, value in asked.headers.items() if name.lower() not in HOP_BY_HOP}
        connection = http.client.HTTPConnection("127.0.0.1", self.target)
        try:
            body = asked.rfile.read(int(asked.headers.get("Content-Length", 0)))
            connection.request(asked.command, "/" + asked.path[len(PREFIX):], body, headers)
            if is_stream:
                self.last_ids.append(asked.headers.get("Last-Event-ID"))
                self.streams.add(asked.connection)
            answer = connection.getresponse()
            asked.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() not in HOP_BY_HOP:
                    asked.send_header(name, value)
            asked.end_headers()
            while piece := answer.read1(1 << 16):  # forward each piece as soon as it arrives
                asked.wfile.write(piece)
                asked.wfile.flush()
        except OSError:
            pass  # the browser or the studio has closed the connection
        finally:
            connection.close()
            self.streams.discard(asked.connection)

    def cut(self):
        """Closes the connections of all event streams."""
        for stream in list(self.streams):
            with contextlib.suppress(OSError):  # the page may have been closed
                stream.shutdown(socket.SHUT_RDWR)

    def end(self):
        self.server.shutdown()
        self.server.server_close()


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def soon(is_so):
    """Waits until is_so() returns True. Returns False on timeout."""
    end = time.monotonic() + PATIENCE
    while not is_so() and time.monotonic() < end:
        time.sleep(0.05)
    return is_so()


def behind_a_proxy(item3d, browser, folder):
    proxy = Proxy()
    proxy.target = free_port()
    with open(f"{folder}/password", "w") as file:
        file.write(PASSWORD + "\n")
    server = Server(item3d, f"{folder}/proxied", str(MUG), "--address", proxy.address, "--password-file", f"{folder}/password",
                    port=proxy.target)
    check(server.base == proxy.address, f"the server prints {server.base} and not the proxy's address {proxy.address}")
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    tab = context.new_page()
    tab.goto(server.address)
    tab.fill("input[type=password]", "another password")
    tab.keyboard.press("Enter")
    tab.wait_for_selector("text=The password is wrong")
    time.sleep(1.1)  # after a wrong password the server refuses attempts for a second
    tab.fill("input[type=password]", PASSWORD)
    tab.keyboard.press("Enter")
    tab.wait_for_selector(".stage")
    cookies = context.cookies()
    check([cookie["path"] for cookie in cookies] == [PREFIX.rstrip("/")], f"the cookie is not of the prefix alone: {cookies}")
    # The request for events must come before last_ids is cleared.
    check(soon(lambda: proxy.last_ids), "the page behind the password does not ask for events")
    tab.close()
    proxy.last_ids.clear()

    page = Page(browser, server.address, context=context)
    page.until("studio.store.state.project !== null && studio.viewer.stage.shown.length === 1", "the model does not come through the proxy")
    result = page.edit("a golden mug", iterations=40)
    page.until(f"(studio.viewer.gallery.live.get('{result}')?.revision ?? -1) > 0", "no texture of the running edit came through the proxy")
    check(page.state_of(result) == "running", "textures came when the edit had ended")
    page.wait_for(result, "done")
    check(proxy.last_ids.count(None) == 1, f"one page, and not one stream of events: the last ids were {proxy.last_ids}")

    before = len(proxy.last_ids)
    proxy.cut()
    page.until("document.querySelector('.toast.bad') !== null", "the page does not say that its events are gone")
    page.until("document.querySelector('.toast.bad') === null", "the page does not come back")
    check(len(proxy.last_ids) > before and all(proxy.last_ids[before:]), f"the page does not say which event was its last: {proxy.last_ids}")
    page.tab.click("#tab-result")
    with page.tab.expect_download() as download:
        page.tab.click(".exports a[download='model.glb']")
    check(download.value.path().read_bytes()[:4] == b"glTF", "the model does not come through the proxy")
    check(not proxy.strays, f"asked for outside of the prefix: {proxy.strays}")
    page.close()
    server.end()
    proxy.end()

"""Pointer events of headless Chromium that are not waited for."""

import socket
import threading

from page_client import WebSocket, until


class Protocol(threading.Thread):
    """The browser's debugging protocol on a socket of its own. Its events are not waited for, so
    they come as fast as they are sent, as those of a mouse.
    """

    def __init__(self, driver, tab=None):
        super().__init__(daemon=True)
        host = driver.capabilities["goog:chromeOptions"]["debuggerAddress"]
        path = f"/devtools/page/{tab or driver.current_window_handle}"
        self.socket, self.number, self.done = WebSocket(f"http://{host}", path=path), 0, {}
        self.socket.socket.settimeout(None)
        self.start()

    def run(self):
        while (message := self.socket.receive()) is not None:
            if "id" in message:
                self.done[message["id"]] = message

    def end(self):
        self.socket.socket.shutdown(socket.SHUT_RDWR)
        self.join()
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def send(self, method, **parameters):
        self.number += 1
        self.socket.order(id=self.number, method=method, params=parameters)
        return self.number

    def mouse(self, kind, x, y, **more):
        return self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def key(self, name, code):
        """The number of its last event's message."""
        key = {"key": name, "code": name, "windowsVirtualKeyCode": code}
        self.send("Input.dispatchKeyEvent", type="rawKeyDown", **key)
        return self.send("Input.dispatchKeyEvent", type="keyUp", **key)

    def drag(self, x, y, dx, dy, steps=5):
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        for n in range(1, steps + 1):
            at = x + dx * n / steps, y + dy * n / steps
            self.mouse("mouseMoved", *at, button="left", buttons=1)
        return self.wait_for(
            self.mouse("mouseReleased", x + dx, y + dy, button="left", clickCount=1)
        )

    def wait_for(self, number):
        """The result of a message; for an event, once the page has had it."""
        return until(lambda: self.done.get(number), 30, f"an answer to message {number}")

    def value(self, text):
        number = self.send("Runtime.evaluate", expression=text, returnByValue=True)
        answer = self.wait_for(number)["result"]
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def middle(self):
        """Of the picture, in pixels of the page."""
        return self.value(
            "(b => [b.x + b.width / 2, b.y + b.height / 2])(canvas.getBoundingClientRect())"
        )

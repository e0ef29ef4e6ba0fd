"""A WebSocket client (RFC 6455), with which tests send messages that a browser would not send."""

import base64
import json
import os
import socket
import struct

WAIT_S = 240  # longest wait for a message, on a busy machine


class Refused(Exception):
    """The server did not answer the handshake with status 101. args[0]: its status; 0: it closed the connection."""


def request(port, text, timeout=WAIT_S):
    """Sends raw bytes and returns the answer of the server, until it closes the connection."""
    with socket.create_connection(("127.0.0.1", port), timeout=timeout) as connection:
        connection.sendall(text.encode() if isinstance(text, str) else text)
        answer = b""
        while True:
            try:
                data = connection.recv(65536)
            except ConnectionResetError:
                return answer
            if not data:
                return answer
            answer += data


class Socket:
    def __init__(self, port, path="/live", host=None, origin=None, timeout=WAIT_S):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        lines = [f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}", "Sec-WebSocket-Version: 13"]
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall("\r\n".join(lines + ["", ""]).encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            data = self.socket.recv(4096)
            if not data:
                self.socket.close()
                raise Refused(0)
            self.buffer += data
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        if status != 101:
            self.socket.close()
            raise Refused(status)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data, opcode=None):
        payload = data.encode() if isinstance(data, str) else data
        opcode = opcode if opcode is not None else 1 if isinstance(data, str) else 2
        mask = os.urandom(4)
        size = len(payload)
        head = bytes([0x80 | opcode]) + (bytes([0x80 | size]) if size < 126 else b"\xfe" + struct.pack(">H", size) if size < 65536
                                         else b"\xff" + struct.pack(">Q", size))
        masked = bytes(a ^ b for a, b in zip(payload, mask * (size // 4 + 1))) if size < 100000 else payload
        self.socket.sendall(head + mask + masked)

    def ask(self, **message):
        """Sends a request and returns its answer. Acknowledges the pictures that arrive before the answer."""
        self.send(json.dumps({"id": 1, **message}))
        while True:
            answer = self.receive()
            if isinstance(answer, dict) and answer["type"] in ("done", "refused"):
                return answer
            if isinstance(answer, bytes):
                self.send('{"do": "drawn"}')

    def bytes(self, count):
        while len(self.buffer) < count:
            data = self.socket.recv(1 << 20)
            if not data:
                raise ConnectionError("the server hung up")
            self.buffer += data
        part, self.buffer = self.buffer[:count], self.buffer[count:]
        return part

    def receive(self):
        """Returns the next message: a text decoded as JSON, or bytes. Raises ConnectionError if the server closed the connection."""
        while True:
            first, size = self.bytes(2)
            if size == 126:
                (size,) = struct.unpack(">H", self.bytes(2))
            elif size == 127:
                (size,) = struct.unpack(">Q", self.bytes(8))
            payload = self.bytes(size)
            assert first & 128, "a message is one frame (docs/live-protocol.md)"
            opcode = first & 15
            if opcode == 1:
                return json.loads(payload)
            if opcode == 2:
                return payload
            if opcode == 8:
                self.send(payload, 8)
                raise ConnectionError(f"the server closed the connection: {payload[2:].decode()}")
            if opcode == 9:
                self.send(payload, 10)

    def state(self):
        """Returns the text (decoded JSON) of the next picture, and acknowledges its poses."""
        state = None
        while True:
            message = self.receive()
            if isinstance(message, bytes):
                self.send('{"do": "drawn"}')
                if state:
                    return state
            elif message["type"] == "state":
                state = message

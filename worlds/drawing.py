"""Draws floor plans in pixels and writes them as PNG, with only the standard library.

The floor plan of a world is solid where a pixel is 127 or darker. Lighter greys are for parts of the drawing that do
not block a robot: the swing of a door, paving, lawn.

All lengths are rounded to pixels once and then drawn with whole numbers, so that a script draws the same picture on
every machine.
"""

import math
import struct
import zlib

WALL = 0          # solid
BODY = 96         # solid: furniture, planting
EDGE = 48         # solid: outline of furniture
SOFT = 176        # not solid: swing of a door, dashed lines
TINT = 232        # not solid: lawn, paving
FLOOR = 255


class Bitmap:
    """A grey picture of width x height metres; +x is right, +y is up, the origin is the lower left corner.

    value: grey of all pixels, 0 (black) to 255 (white).
    """

    def __init__(self, width_m, height_m, pixels_per_m, value=FLOOR):
        self.scale = pixels_per_m
        self.width = self.px(width_m)
        self.height = self.px(height_m)
        self.rows = [bytearray([value]) * self.width for _ in range(self.height)]

    def px(self, metres):
        """Converts a length to whole pixels."""
        return math.floor(metres * self.scale + 0.5)

    def span(self, y, x0, x1, value):
        """Sets the pixels x0 <= x < x1 of row y (counted from the bottom). Ignores pixels outside the picture."""
        x0, x1 = max(x0, 0), min(x1, self.width)
        if 0 <= y < self.height and x0 < x1:
            self.rows[self.height - 1 - y][x0:x1] = bytes([value]) * (x1 - x0)

    def get(self, x, y):
        return self.rows[self.height - 1 - y][x]

    def rect_px(self, x0, y0, x1, y1, value):
        for y in range(min(y0, y1), max(y0, y1)):
            self.span(y, min(x0, x1), max(x0, x1), value)

    def line_px(self, x0, y0, x1, y1, value, pen=1, dash=0):
        """Bresenham's line with a square pen of `pen` pixels. dash: length of dashes and gaps, pixels; 0: no gaps."""
        dx, dy = abs(x1 - x0), -abs(y1 - y0)
        sx, sy = (1 if x0 < x1 else -1), (1 if y0 < y1 else -1)
        error, low, step = dx + dy, -(pen // 2), 0
        while True:
            if not dash or step // dash % 2 == 0:
                self.rect_px(x0 + low, y0 + low, x0 + low + pen, y0 + low + pen, value)
            if x0 == x1 and y0 == y1:
                return
            step += 1
            twice = 2 * error
            if twice >= dy:
                error += dy
                x0 += sx
            if twice <= dx:
                error += dx
                y0 += sy

    def disc_px(self, cx, cy, r, value):
        for dy in range(-r, r + 1):
            half = math.isqrt(r * r + r - dy * dy) if r * r + r >= dy * dy else 0
            self.span(cy + dy, cx - half, cx + half + 1, value)

    def ring_px(self, cx, cy, r, value, pen=1, sides=(True, True, True, True)):
        """A circle with a line of `pen` pixels. sides: which quarters are drawn (+x+y, -x+y, -x-y, +x-y)."""
        outer, inner = r * r + r, (r - pen) * (r - pen) + (r - pen)
        for dy in range(-r, r + 1):
            reach = math.isqrt(max(outer - dy * dy, 0))
            for dx in range(-reach, reach + 1):
                quarter = (0 if dx >= 0 else 1) if dy >= 0 else (3 if dx >= 0 else 2)
                if dx * dx + dy * dy > inner and sides[quarter]:
                    self.span(cy + dy, cx + dx, cx + dx + 1, value)

    def polygon_px(self, points, value):
        """Fills the pixels whose centre is inside the polygon, by the even-odd rule."""
        ys = [y for _, y in points]
        for y in range(min(ys), max(ys)):
            cuts = []
            for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
                if (ay <= y) != (by <= y):
                    # The edge at height y + 1/2, rounded up to the first pixel centre at or right of it.
                    top, bottom = (2 * y + 1 - 2 * ay) * (bx - ax), 2 * (by - ay)
                    if bottom < 0:
                        top, bottom = -top, -bottom
                    cuts.append(ax - (-(2 * top - bottom) // (2 * bottom)))
            cuts.sort()
            for left, right in zip(cuts[::2], cuts[1::2]):
                self.span(y, left, right, value)

    def write_png(self, path):
        raw = bytearray()
        above = bytes(self.width)
        for row in self.rows:
            raw.append(2)  # filter "up" compresses best, because neighbouring rows are similar
            raw += bytes((a - b) & 255 for a, b in zip(row, above))
            above = row

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        header = struct.pack(">IIBBBBB", self.width, self.height, 8, 0, 0, 0, 0)  # 8 bit grey
        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                       chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b""))


class Pen:
    """Draws in metres in a frame (u, v): the point (u, v) is at origin + u * along + v * into.

    `along` and `into` are axis-aligned unit vectors. A function that draws a room with a pen can therefore draw it on
    any side of a corridor.
    """

    def __init__(self, bitmap, origin=(0, 0), along=(1, 0), into=(0, 1)):
        self.bitmap, self.origin, self.along, self.into = bitmap, origin, along, into

    def at(self, u, v):
        return (self.origin[0] + u * self.along[0] + v * self.into[0],
                self.origin[1] + u * self.along[1] + v * self.into[1])

    def moved(self, u, v=0):
        return Pen(self.bitmap, self.at(u, v), self.along, self.into)

    def mirrored(self, u):
        """Returns a pen at u whose `along` has the opposite direction."""
        return Pen(self.bitmap, self.at(u, 0), (-self.along[0], -self.along[1]), self.into)

    def px(self, u, v):
        x, y = self.at(u, v)
        return self.bitmap.px(x), self.bitmap.px(y)

    def rect(self, u0, v0, u1, v1, value=WALL):
        self.bitmap.rect_px(*self.px(u0, v0), *self.px(u1, v1), value)

    def clear(self, u0, v0, u1, v1):
        self.rect(u0, v0, u1, v1, FLOOR)

    def body(self, u0, v0, u1, v1):
        """A piece of furniture: a solid rectangle with an outline."""
        (x0, y0), (x1, y1) = self.px(u0, v0), self.px(u1, v1)
        x0, x1, y0, y1 = min(x0, x1), max(x0, x1), min(y0, y1), max(y0, y1)
        self.bitmap.rect_px(x0, y0, x1, y1, EDGE)
        self.bitmap.rect_px(x0 + 1, y0 + 1, x1 - 1, y1 - 1, BODY)

    def line(self, u0, v0, u1, v1, value=EDGE, pen=1, dash=0):
        self.bitmap.line_px(*self.px(u0, v0), *self.px(u1, v1), value, pen, dash)

    def disc(self, u, v, r, value=BODY, rim=EDGE):
        x, y = self.px(u, v)
        pixels = self.bitmap.px(r)
        self.bitmap.disc_px(x, y, pixels, rim)
        self.bitmap.disc_px(x, y, pixels - 1, value)

    def ring(self, u, v, r, value=EDGE, pen=1):
        self.bitmap.ring_px(*self.px(u, v), self.bitmap.px(r), value, pen)

    def arc(self, u, v, r, towards_u, towards_v, value=SOFT, pen=1):
        """A quarter of a circle. towards_u, towards_v: 1 or -1, the signs of u and v in the quarter."""
        dx = towards_u * self.along[0] + towards_v * self.into[0]
        dy = towards_u * self.along[1] + towards_v * self.into[1]
        quarter = (0 if dx > 0 else 1) if dy > 0 else (3 if dx > 0 else 2)
        self.bitmap.ring_px(*self.px(u, v), self.bitmap.px(r), value, pen,
                            tuple(i == quarter for i in range(4)))

    def polygon(self, points, value=BODY):
        self.bitmap.polygon_px([self.px(u, v) for u, v in points], value)

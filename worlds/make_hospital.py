#!/usr/bin/env python3
"""Draws hospital.png, the floor plan of a hospital of 140 x 60 m.

A street, the main corridor, 3.7 m wide, runs along the whole building. South of the street are consulting rooms, north
of it open waiting bays and the departments. North of the departments a second corridor leads to four wards with gardens
between them. Every room has a door, every garden has an entrance, and the outer wall is closed: a robot can reach all
rooms but cannot leave the building.
"""

import os

from drawing import BODY, EDGE, FLOOR, SOFT, TINT, WALL, Bitmap, Pen

LENGTH, DEPTH = 140, 60
PIXELS_PER_M = 22
FACADE = 0.36      # thickness of outer walls, m
INNER = 0.18       # walls along corridors
PARTITION = 0.14   # walls between rooms

# The horizontal bands of the plan: y of the inner faces of their south and north walls, m.
SOUTH_ROOMS = (FACADE, 7.6)
STREET = (7.8, 11.5)
BAYS = (11.5, 16.6)
DEPARTMENTS = (16.8, 23.8)
BACK_CORRIDOR = (24.0, 26.8)
GARDENS = (BACK_CORRIDOR[1] + FACADE, DEPTH - FACADE)
HALL = (62.0, 78.0)
WARDS = (7.5, 42.5, 77.5, 112.5)   # west face of each ward
WARD_WIDTH = 20.0


# --- parts of a building ------------------------------------------------------------------------------------

def door(pen, u, width=1.1, thickness=INNER, ajar=True):
    """An opening of the wall below v = 0, from u to u + width, and its leaf, which opens into the room.
    ajar: the leaf is half open, else fully open."""
    pen.clear(u, -thickness - 0.02, u + width, 0)
    leaf = width - 0.1
    if ajar:  # the leaf at about 63 degrees: two pixels in v for one pixel in u
        pen.line(u, 0, u + 0.45 * leaf, 0.9 * leaf, WALL, 2)
    else:
        pen.rect(u, -thickness, u + 0.08, leaf)
    pen.arc(u, 0, leaf, 1, 1)


def double_door(pen, u, width=1.9, thickness=INNER):
    door(pen, u, width / 2, thickness, ajar=False)
    pen.clear(u + width / 2, -thickness - 0.02, u + width, 0)
    pen.rect(u + width - 0.08, -thickness, u + width, width / 2 - 0.1)
    pen.arc(u + width, 0, width / 2 - 0.1, -1, 1)


def window(pen, u, width, mullion=True):
    """A niche in the inside of the facade (v < 0), and glass in another grey, which is as solid as the wall."""
    pen.rect(u, 0.08 - FACADE, u + width, -0.18, BODY)
    pen.clear(u, -0.18, u + width, 0)
    if mullion:
        pen.rect(u + width / 2 - 0.07, -0.18, u + width / 2 + 0.07, -0.05)


def column(pen, u, v, r=0.32):
    pen.disc(u, v, r, WALL, WALL)


# --- furniture ----------------------------------------------------------------------------------------------

def rounded(pen, u, v, r):
    """Round furniture, as a polygon with few corners, because a circle of r = 0.4 m would have fifty edges."""
    steps = ((1.0, 0.45), (0.8, 0.8), (0.45, 1.0)) if r > 0.3 else ((1.0, 0.6), (0.6, 1.0))
    for a, b in steps:
        pen.rect(u - a * r, v - b * r, u + a * r, v + b * r, EDGE)
    for a, b in steps:
        pen.rect(u - a * r + 0.05, v - b * r + 0.05, u + a * r - 0.05, v + b * r - 0.05, BODY)


def stool(pen, u, v):
    rounded(pen, u, v, 0.21)


def chair(pen, u, v, back=1):
    """A chair, 0.46 m wide, with its centre at (u, v). back: 1: its back is towards +v; -1: towards -v."""
    pen.body(u - 0.23, v - 0.22, u + 0.23, v + 0.22)
    pen.rect(u - 0.23, v + back * 0.22, u + 0.23, v + back * 0.15, WALL)


def seats(pen, u, v, count, back=1):
    for i in range(count):
        chair(pen, u + 0.62 * i, v, back)


def table(pen, u, v, r, places):
    rounded(pen, u, v, r)
    for du, dv in ((1, 0), (0, 1), (-1, 0), (0, -1))[:places]:
        du, dv = u + du * (r + 0.42), v + dv * (r + 0.42)
        pen.body(du - 0.21, dv - 0.21, du + 0.21, dv + 0.21)


def bed(pen, u, v):
    """A bed with its head at the wall at u. It covers u - 2.05 m to u, and v to v + 0.95 m."""
    pen.body(u - 2.05, v, u, v + 0.95)
    pen.rect(u - 0.5, v + 0.15, u - 0.12, v + 0.8, EDGE)
    pen.line(u - 0.65, v, u - 0.65, v + 0.93, WALL)
    pen.body(u - 0.45, v - 0.6, u, v - 0.15)
    pen.line(u - 2.2, v - 0.45, u - 2.2, v + 1.3, SOFT, 1, 4)


def basin(pen, u, v):
    pen.body(u - 0.28, v - 0.05, u + 0.28, v + 0.3)
    rounded(pen, u, v + 0.3, 0.16)


def toilet(pen, u, v):
    pen.body(u - 0.22, v - 0.02, u + 0.22, v + 0.2)
    rounded(pen, u, v + 0.38, 0.19)


def desk(pen, u, v, width=1.5):
    pen.body(u, v, u + width, v + 0.72)
    pen.body(u + width - 0.55, v + 0.6, u + width, v + 1.4)
    stool(pen, u + 0.55, v + 1.12)


def shelves(pen, u, v, length, count, pitch=1.25):
    for i in range(count):
        pen.body(u, v + pitch * i, u + length, v + pitch * i + 0.4)


def cross(pen, u0, v0, u1, v1):
    """A lift shaft: a box with its diagonals."""
    pen.body(u0, v0, u1, v1)
    pen.line(u0, v0, u1, v1, WALL)
    pen.line(u0, v1, u1, v0, WALL)


def stairs(pen, u0, v0, u1, v1):
    """Two flights of stairs with an open landing at the far end. Solid treads and treads of floor alternate."""
    middle = (u0 + u1) / 2
    pen.rect(middle - 0.06, v0, middle + 0.06, v1 - 1.2)
    v = v0
    while v < v1 - 1.3:
        pen.body(u0, v, middle - 0.4, v + 0.2)
        pen.body(middle + 0.4, v, u1, v + 0.2)
        v += 0.42


def shrub(pen, u, v, r):
    """A bush of three lobes."""
    lobes = ((0.5, 0.15), (-0.35, 0.42), (-0.12, -0.5))
    for du, dv in lobes:
        pen.disc(u + du * r, v + dv * r, 0.58 * r)
    pen.disc(u, v, 0.5 * r, BODY, BODY)
    for du, dv in lobes:
        pen.ring(u + du * r, v + dv * r, 0.3 * r, EDGE)


def tree(pen, u, v, r):
    """A solid trunk under a crown that is drawn but not solid."""
    x, y = pen.px(u, v)
    pen.bitmap.disc_px(x, y, pen.bitmap.px(r), 208)
    for part in (1.0, 0.72, 0.45):
        pen.ring(u, v, part * r, SOFT)
    pen.body(u - 0.2, v - 0.2, u + 0.2, v + 0.2)


# --- rooms of w x d metres: u runs along the corridor, v into the room --------------------------------------

def consulting(pen, w, d):
    desk(pen, 0.3, d - 2.6)
    chair(pen, 0.8, d - 3.2, -1)
    chair(pen, 1.5, d - 3.2, -1)
    pen.body(w - 0.85, d - 2.9, w - 0.12, d - 0.95)
    pen.rect(w - 0.7, d - 1.4, w - 0.28, d - 1.05, EDGE)
    pen.line(w - 1.5, d - 3.0, w - 0.95, d - 4.0, EDGE, 2)
    pen.body(w - 0.45, 1.9, w, 2.5)
    pen.body(0.05, 2.2, 0.5, 3.6)


def office(pen, w, d):
    desk(pen, 0.4, d - 2.4)
    desk(pen, w - 2.0, d - 4.9)
    table(pen, w - 1.2, d - 1.5, 0.45, 2)
    pen.body(0.05, 2.0, 0.45, d - 3.0)
    chair(pen, w - 0.6, 1.0, -1)


def laboratory(pen, w, d):
    for k in range(int((w - 1.4) / 2.1)):
        u = 1.3 + 2.1 * k
        pen.body(u, 1.7, u + 0.75, d - 1.1)
        pen.rect(u + 0.32, 1.8, u + 0.42, d - 1.2, EDGE)
        for i in range(3):
            stool(pen, u + 1.05, 2.1 + 1.2 * i)
    pen.body(0.02, 2.4, 0.55, d - 0.02)
    pen.body(0.55, d - 0.5, w - 0.02, d - 0.02)


def pharmacy(pen, w, d):
    shelves(pen, 0.9, 2.6, w / 2 - 1.5, 4, 1.05)
    shelves(pen, w / 2 + 0.5, 2.6, w / 2 - 1.3, 4, 1.05)
    pen.body(2.2, 1.2, w - 1.2, 1.65)


def imaging(pen, w, d):
    u, v = w / 2 + 0.4, d - 2.4
    pen.disc(u, v, 1.15, BODY)
    pen.disc(u, v, 0.5, WALL)
    pen.body(u - 0.32, v - 3.0, u + 0.32, v - 0.9)
    # the control room: a screen with cut corners
    pen.line(0, 3.4, 1.1, 3.4, WALL, 3)
    pen.line(1.1, 3.4, 1.7, 2.8, WALL, 3)
    pen.body(0.05, 4.2, 0.6, d - 0.4)
    pen.body(0.05, 2.55, 1.0, 3.05)
    stool(pen, 0.6, 2.1)
    pen.body(w - 0.55, 1.6, w - 0.05, d - 3.8)


def treatment(pen, w, d):
    for i in range(2):
        v = 1.9 + 2.5 * i
        bed(pen, w - 0.1, v)
        if i:
            pen.rect(w - 2.3, v - 0.85, w, v - 0.77)
    pen.body(0.05, 2.0, 0.55, d - 0.6)
    table(pen, 1.5, d - 1.2, 0.4, 2)
    basin(pen, w - 1.2, 0.05)


def lavatories(pen, w, d):
    count = int((w - 0.1) / 1.15)
    for i in range(count):
        u = 0.05 + i * (w - 0.1) / count
        width = (w - 0.1) / count
        if i:
            pen.rect(u - 0.04, d - 1.7, u + 0.04, d)
        toilet(Pen(pen.bitmap, pen.at(u + width / 2, d), pen.along, (-pen.into[0], -pen.into[1])), 0, 0)
        pen.rect(u - 0.04, d - 1.78, u + 0.45, d - 1.7)
        if 1.8 + 0.8 * i < w - 0.4:
            basin(pen, 1.8 + 0.8 * i, 0)
    pen.rect(0, 2.7, w / 2 - 0.2, 2.84)
    for i in range(3):
        pen.body(0.06, 3.1 + 0.75 * i, 0.4, 3.5 + 0.75 * i)


def physiotherapy(pen, w, d):
    pen.body(w - 1.1, 1.6, w - 0.1, 3.6)
    pen.body(w - 1.1, 4.1, w - 0.1, 6.1)
    for i in range(2):
        pen.line(0.7 + 0.8 * i, 2.2, 0.7 + 0.8 * i, d - 1.0, EDGE, 2)
    rounded(pen, w / 2, d - 1.4, 0.45)
    rounded(pen, w / 2 + 0.1, 3.0, 0.33)
    rounded(pen, w / 2 - 0.2, 4.3, 0.26)


def chapel(pen, w, d):
    for i in range(5):
        v = 1.8 + 0.8 * i
        pen.body(0.9, v, w / 2 - 0.6, v + 0.35)
        pen.body(w / 2 + 0.6, v, w - 0.9, v + 0.35)
    pen.body(w / 2 - 0.8, d - 1.0, w / 2 + 0.8, d - 0.5)
    for side in (-1, 1):
        pen.line(w / 2 + side * 2.0, d - 0.05, w / 2 + side * 3.2, d - 1.4, WALL, 3)


def lecture(pen, w, d):
    """A lecture hall: rows of seats, longer with the distance from the desk, each interrupted by two aisles."""
    for i in range(3):
        v = 2.7 + 1.3 * i
        half = 2.7 + 0.9 * i
        bend = half * 0.5
        pen.body(w / 2 - bend, v, w / 2 + bend, v + 0.3)
        for side in (-1, 1):
            pen.line(w / 2 + side * (bend + 0.8), v + 0.1, w / 2 + side * (half + 0.3), v + 0.1 - 0.45 * (half - bend),
                     EDGE, 5)
    pen.body(w / 2 - 0.9, 1.0, w / 2 + 0.9, 1.5)


def kitchen(pen, w, d):
    pen.body(0.05, 1.9, 0.75, d - 0.05)
    pen.body(0.75, d - 0.7, w - 0.05, d - 0.05)
    for k in range(int((w - 2.6) / 2.4)):
        u = 2.0 + 2.4 * k
        pen.body(u, 2.2, u + 1.1, d - 2.0)
        for i in range(3):
            pen.disc(u + 0.55, 2.7 + 0.8 * i, 0.25, BODY, WALL)
    pen.body(w - 0.7, 1.7, w - 0.05, d - 1.6)


def theatre(pen, w, d):
    """An operating theatre: an octagon in a square room."""
    cut = 0.5
    for side in (0, 1):
        u0, s = (0, 1) if side == 0 else (w, -1)
        pen.line(u0 + s * cut, d, u0, d - cut, WALL, 3)
    pen.line(w, cut, w - cut, 0, WALL, 3)
    u, v = w / 2, d / 2 + 0.2
    pen.body(u - 0.3, v - 1.0, u + 0.3, v + 1.0)
    pen.disc(u, v - 1.2, 0.25)
    pen.ring(u, v, 0.9, SOFT)
    for du, dv in ((-1.5, -0.9), (1.4, 0.7), (-1.5, 0.9), (1.5, -0.9)):
        pen.body(u + du - 0.3, v + dv - 0.22, u + du + 0.3, v + dv + 0.22)
    for du, dv in ((-0.8, 0.1), (0.85, -0.2), (0.7, 1.2)):
        stool(pen, u + du, v + dv)


def recovery(pen, w, d):
    for i in range(int((w - 0.4) / 2.0)):
        u = 0.9 + 2.0 * i
        bay = Pen(pen.bitmap, pen.at(u, d), pen.into, pen.along)
        bed(bay, -0.1, 0)
        if i:
            pen.line(u - 0.75, d, u - 0.75, d - 1.6, EDGE, 2)
    pen.body(w / 2 - 1.4, 2.0, w / 2 + 1.4, 2.6)
    pen.body(w / 2 - 1.4, 1.4, w / 2 - 0.9, 2.0)
    pen.body(w / 2 + 0.9, 1.4, w / 2 + 1.4, 2.0)
    stool(pen, w / 2 - 0.6, 3.0)
    stool(pen, w / 2 + 0.6, 3.0)


def store(pen, w, d):
    shelves(pen, 0.5, 2.0, w - 1.9, int((d - 2.2) / 1.1), 1.1)


def patient(pen, w, d):
    """A room of a ward: a bathroom next to the door, a bed, a chair at the window."""
    pod_u, pod_v = 1.85, 2.1
    pen.rect(0, pod_v - PARTITION, pod_u, pod_v)
    pen.rect(pod_u - PARTITION, 0, pod_u, 0.25)
    pen.rect(pod_u - PARTITION, 1.25, pod_u, pod_v)
    pen.line(pod_u - 0.07, 0.3, pod_u - 0.07, 1.2, SOFT)
    pen.body(0.0, 1.3, 0.6, 1.65)
    pen.body(0.25, 0.0, 0.8, 0.35)
    bed(pen, w - 0.02, 2.75)
    pen.body(0.02, d - 2.9, 0.55, d - 1.7)
    pen.body(0.4, d - 1.0, 0.95, d - 0.45)
    pen.body(w - 0.75, d - 1.0, w - 0.1, d - 0.35)


# --- bands of rooms -----------------------------------------------------------------------------------------

def rooms(bitmap, y_wall, into, x, depth, plan):
    """Draws a row of rooms along the corridor wall at y_wall, beginning at x; returns the x of its end.

    into: 1: the rooms are north of the wall; -1: south of it. plan: for each room its function, its width, the
    position of its door, and whether the door is half open.
    """
    for fill, width, place, ajar in plan:
        pen = Pen(bitmap, (x, y_wall), (1, 0), (0, into))
        pen.rect(-PARTITION / 2, 0, PARTITION / 2, depth)
        pen.rect(width - PARTITION / 2, 0, width + PARTITION / 2, depth)
        inside = pen.moved(PARTITION / 2)
        fill(inside, width - PARTITION, depth)
        door(inside, place, 1.2 if fill is not lavatories else 1.0, INNER + 0.02, ajar)
        x += width
    return x


def waiting(bitmap, x, y, width, depth, into):
    """An open waiting bay: rows of seats and a planter."""
    pen = Pen(bitmap, (x, y), (1, 0), (0, into))
    count = int((width - 2.6) / 0.62)
    seats(pen, 1.9, depth - 0.4, count, 1)
    rounded(pen, 0.75, depth - 0.75, 0.45)
    pen.ring(0.75, depth - 0.75, 0.25, WALL)
    seats(pen, 2.4, depth - 2.3, max(count - 2, 2), -1)
    seats(pen, 2.4, depth - 1.72, max(count - 2, 2), 1)


def street(bitmap):
    pen = Pen(bitmap)
    south, north = SOUTH_ROOMS[1], DEPARTMENTS[0]
    # The south wall of the street, the two long walls of the departments, and the wall towards the gardens.
    pen.rect(0, south, LENGTH, STREET[0])
    pen.rect(0, BAYS[1], LENGTH, north)
    pen.rect(0, DEPARTMENTS[1], LENGTH, BACK_CORRIDOR[0])
    pen.rect(0, BACK_CORRIDOR[1], LENGTH, GARDENS[0])

    # Consulting rooms with open waiting rooms between them.
    depth = south - FACADE
    x = FACADE
    plan = ((consulting, 4.2), (None, 7.4), (consulting, 4.0), (office, 4.4), (None, 7.0), (consulting, 4.0),
            (lavatories, 4.6), (None, 7.4), (consulting, 4.0), (treatment, 4.6), (None, 6.0), (office, 4.04))
    spans = [(x, HALL[0] - FACADE, plan),
             (HALL[1] + PARTITION, LENGTH - FACADE,
              ((office, 4.2), (treatment, 4.6), (None, 7.2), (treatment, 4.6), (treatment, 4.6), (physiotherapy, 5.6),
               (None, 6.6), (imaging, 5.6), (lavatories, 4.6), (consulting, 4.2), (None, 6.0), (store, 3.5)))]
    for start, end, parts in spans:
        stretch = (end - start) / sum(width for _, width in parts)
        at = start
        for i, (fill, width) in enumerate(parts):
            width *= stretch
            if fill is None:
                pen.clear(at + PARTITION, south, at + width - PARTITION, STREET[0])
                waiting(bitmap, at, STREET[0] - 0.2, width, depth, -1)
                column(pen, at + 0.2, STREET[0] - 0.12, 0.28)
                column(pen, at + width - 0.2, STREET[0] - 0.12, 0.28)
            else:
                rooms(bitmap, south, -1, at, depth, ((fill, width, 0.5 if i % 2 else 0.7, i % 3 == 0),))
            at += width
    u = FACADE + 0.9
    while u < LENGTH - 3:
        if not HALL[0] - 3 < u < HALL[1] + 1:
            window(Pen(bitmap, (u, FACADE)), 0, 1.5)
        u += 2.8

    # Pilasters along the south wall of the street; posts where this wall is open, and along the waiting bays.
    u = FACADE + 0.55
    while u < LENGTH - FACADE - 0.5:
        x, y = bitmap.px(u), bitmap.px(south) + 1
        if bitmap.get(x - 4, y) == WALL and bitmap.get(x + bitmap.px(0.3) + 4, y) == WALL:
            pen.rect(u, STREET[0], u + 0.3, STREET[0] + 0.12)
        elif bitmap.get(x - 4, y) == bitmap.get(x + 14, y) == FLOOR and not HALL[0] < u < HALL[1]:
            pen.body(u + 0.07, south, u + 0.23, south + 0.16)
        pen.body(u + 0.07, BAYS[0] + 0.3, u + 0.23, BAYS[0] + 0.46)
        u += 0.95

    # Waiting bays north of the street, behind a row of round columns.
    x, i = 3.2, 0
    while x < LENGTH - 2:
        if not HALL[0] - 1 < x < HALL[1] + 1:
            column(pen, x, BAYS[0] + 0.35)
        x += 4.6
    edges = [FACADE, 8.6, 15.6, 19.4, 27.4, 35.6, 43.2, 50.6, 54.4, HALL[0] - 0.2, HALL[1] + 0.2, 85.6, 89.4, 97.6,
             105.4, 113.0, 120.6, 124.4, 132.0, LENGTH - FACADE]
    for i, (left, right) in enumerate(zip(edges, edges[1:])):
        if right - left < 4 or left == HALL[0] - 0.2:
            continue
        waiting(bitmap, left + 0.2, BAYS[0] + 0.1 + 0.4 * (i % 2), right - left - 0.2, 3.6, 1)
        pen.rect(right - 0.08, BAYS[1] - 2.3, right + 0.08, BAYS[1])
        if i % 2:
            pen.line(right, BAYS[1] - 2.3, right - 0.8, BAYS[1] - 3.1, WALL, 3)


def departments(bitmap):
    y0, y1 = DEPARTMENTS
    depth = y1 - y0
    pen = Pen(bitmap)
    plans = ((FACADE, 16.0, ((laboratory, 7.8), (pharmacy, 7.84))),
             (19.0, 51.0, ((imaging, 6.4), (laboratory, 5.6), (office, 4.2), (treatment, 4.8), (lavatories, 5),
                           (physiotherapy, 6))),
             (54.0, 86.0, ((office, 5), (chapel, 8.4), (lecture, 11), (kitchen, 7.6))),
             (89.0, 121.0, ((theatre, 6.8), (store, 4.2), (theatre, 6.8), (recovery, 9.2), (laboratory, 5))),
             (124.0, LENGTH - FACADE, ((recovery, 9), (office, 6.64))))
    for start, end, plan in plans:
        x = start
        for i, (fill, width) in enumerate(plan):
            rooms(bitmap, y0, 1, x, depth, ((fill, width, 0.4, i % 3 == 0),))
            x += width
            # A second door, to the back corridor.
            if width > 6:
                back = Pen(bitmap, (x - 0.3, y1), (-1, 0), (0, -1))
                if fill in (pharmacy, chapel, recovery):
                    door(back, 0.3, 1.1, INNER + 0.02, False)
        pen.rect(start - PARTITION, y0, start, y1)
        pen.rect(end, y0, end + PARTITION, y1)
    for left, right in ((16.0, 19.0), (51.0, 54.0), (86.0, 89.0), (121.0, 124.0)):
        pen.clear(left + PARTITION, BAYS[1], right - PARTITION + PARTITION, y0)
        pen.clear(left + PARTITION, y1, right, BACK_CORRIDOR[0])
        pen.body(left + PARTITION, y0 + 3.0, left + 0.45, y0 + 3.6)


def entrance_hall(bitmap):
    pen = Pen(bitmap)
    left, right = HALL
    pen.clear(left, SOUTH_ROOMS[1], right, STREET[0])
    pen.rect(left - FACADE, FACADE, left, STREET[0])
    pen.rect(right, FACADE, right + FACADE, STREET[0])
    middle = (left + right) / 2
    # The revolving door, in a lobby with cut corners.
    pen.rect(middle - 3.4, 0.12, middle + 3.4, 0.24, BODY)
    bitmap.ring_px(*pen.px(middle, 1.75), bitmap.px(1.3), WALL, 3, (True, False, True, False))
    pen.rect(middle - 0.05, 0.95, middle + 0.05, 2.55, EDGE)
    pen.rect(middle - 0.8, 1.7, middle + 0.8, 1.8, EDGE)
    for side in (-1, 1):
        pen.line(middle + side * 3.6, FACADE, middle + side * 2.4, 2.2, WALL, 3)
        seats(pen, middle + side * 5.6 - 0.6, 0.95, 3, -1)
        rounded(pen, middle + side * 7.2, 1.1, 0.55)
        column(pen, middle + side * 4.6, 7.3, 0.36)
        table(pen, middle + side * 3.4, 5.6, 0.45, 4)
        table(pen, middle + side * 6.7, 3.4, 0.42, 4)
        # reception, towards the street
        bitmap.ring_px(*pen.px(middle, 14.6), bitmap.px(2.4), BODY, 14, (False, False, True, True))
        pen.body(middle + side * 2.05 - 0.33, 14.6, middle + side * 2.05 + 0.33, 15.6)
        stool(pen, middle + side * 1.0, 14.2)
        column(pen, middle + side * 4.6, 12.2, 0.36)
        table(pen, middle + side * 6.0, 15.0, 0.42, 4)


def garden(bitmap, x0, x1, gate):
    """A garden from x0 to x1: a lawn, paths that cross at a fountain, shrubs along the walls, trees.
    gate: x of the middle of its door, m."""
    y0, y1 = GARDENS
    pen = Pen(bitmap, (x0, y0))
    w, d = x1 - x0, y1 - y0
    pen.rect(0, 0, w, d, TINT)
    for k in range(1, int(w / 0.5)):
        pen.line(0.5 * k, 0.2, 0.5 * k, d - 0.2, 222, 1, 5)
    pen.clear(w / 2 - 0.9, 0, w / 2 + 0.9, d)
    pen.clear(0.9, d / 2 - 0.8, w - 0.9, d / 2 + 0.8)
    pen.bitmap.disc_px(*pen.px(w / 2, d / 2), bitmap.px(2.7), FLOOR)
    pen.disc(w / 2, d / 2, 1.0)
    pen.ring(w / 2, d / 2, 0.65, WALL)
    pen.disc(w / 2, d / 2, 0.3, WALL)
    broad = w > 10
    for v in (8.2, 13.6, 19.1, 24.6) if broad else ():
        tree(pen, 3.6, v, 1.35)
        tree(pen, w - 3.6, v, 1.35)
    for i in range(6 if broad else 5):
        v = 2.6 + (d - 5.2) * i / (5 if broad else 4)
        for side in (0, 1):
            u = 1.5 + 0.35 * ((i + side) % 3) if side == 0 else w - 1.5 - 0.35 * ((i + 2 * side) % 3)
            if abs(v - d / 2) < 1.7:
                continue
            if i or not broad:
                pen.body(u - 0.5, v - 1.6, u + 0.5, v + 1.6)
            else:
                shrub(pen, u, v, 0.95 + 0.12 * ((3 * i + side) % 3))
    for v in (d / 4, 3 * d / 4) if broad else ():
        for side in (-1, 1):
            pen.body(w / 2 + side * 1.35 - 0.22, v - 0.8, w / 2 + side * 1.35 + 0.22, v + 0.8)
    # The entrance from the back corridor.
    double_door(Pen(bitmap, (gate - 0.95, y0)), 0, 1.9, FACADE + 0.02)
    for u in (1, int(w) - 3):
        if broad:
            window(Pen(bitmap, (x0 + u, BACK_CORRIDOR[1]), (1, 0), (0, -1)), 0, 1.4)


def ward(bitmap, x0):
    """A ward: patients' rooms on both sides of a ring of corridors, with stairs, nurses' base and stores inside it."""
    y0, y1 = BACK_CORRIDOR[1], DEPTH
    pen = Pen(bitmap, (x0, 0))
    pen.rect(0, y0, WARD_WIDTH, y1)
    pen.clear(FACADE, y0 + FACADE, WARD_WIDTH - FACADE, y1 - FACADE)
    depth = 5.6
    west, east = FACADE + depth, WARD_WIDTH - FACADE - depth   # faces of the corridor walls towards the rooms
    first, last, count = 30.8, 55.4, 5
    width = (last - first) / count
    pen.rect(west, y0 + FACADE, west + INNER, last)
    pen.rect(east - INNER, y0 + FACADE, east, last)
    for i in range(count + 1):
        y = first + i * width
        pen.rect(FACADE, y - PARTITION / 2, west, y + PARTITION / 2)
        pen.rect(east, y - PARTITION / 2, WARD_WIDTH - FACADE, y + PARTITION / 2)
    for i in range(count):
        for side in (0, 1):
            wall_u, into = (west, -1) if side == 0 else (east, 1)
            y = first + i * width + PARTITION / 2
            room = Pen(bitmap, (x0 + wall_u, y), (0, 1), (into, 0))
            if i % 2:
                room = room.mirrored(width - PARTITION)
            patient(room, width - PARTITION, depth)
            door(room, 2.35, 1.25, INNER + 0.02, i == 4 - 3 * side)
            facade = FACADE if side == 0 else WARD_WIDTH - FACADE
            window(Pen(bitmap, (x0 + facade, y), (0, 1), (-into, 0)), 1.0, 2.2, mullion=False)
    # The lobby: the entrance from the back corridor, with an office and a linen store next to it.
    middle = WARD_WIDTH / 2
    pen.clear(middle - 1.5, y0 - 0.02, middle + 1.5, y0 + FACADE)
    for side in (-1, 1):
        pen.rect(middle + side * 1.5, y0 + FACADE, middle + side * 1.64, y0 + FACADE + 1.2)
    for side in (0, 1):
        wall_u, into = (west, -1) if side == 0 else (east, 1)
        room = Pen(bitmap, (x0 + wall_u, y0 + FACADE), (0, 1), (into, 0))
        door(room, 1.9, 1.1, INNER + 0.02, side == 0)
        if side == 0:
            room.body(0.3, 1.0, 1.0, 2.6)
            stool(room, 1.35, 1.8)
            room.body(0.1, 4.6, 2.9, 5.1)
            table(room, 2.2, 3.6, 0.4, 2)
        else:
            for k in range(4):
                room.body(0.1, 1.5 + 1.0 * k, 1.7, 1.9 + 1.0 * k)
    # The stairs and lifts inside the ring of corridors.
    left, right = middle - 1.45, middle + 1.45
    pen.rect(left, 32.4, right, 38.6)
    pen.clear(left + PARTITION, 32.4 + PARTITION, right - PARTITION, 38.6)
    stairs(pen, left + PARTITION, 33.7, right - PARTITION, 38.6)
    cross(pen, left + 0.1, 32.5, middle - 0.05, 33.7)
    cross(pen, middle + 0.05, 32.5, right - 0.1, 33.7)
    # nurses' base: two counters with round ends, open to north and south
    for side in (-1, 1):
        pen.body(middle + side * 1.45 - (0.5 if side > 0 else 0), 42.0, middle + side * 1.45 + (0 if side > 0 else 0.5),
                 45.4)
        pen.body(middle + side * 0.7, 42.0, middle + side * 1.45, 42.45)
        pen.body(middle + side * 0.4, 44.95, middle + side * 1.45, 45.4)
        chair(pen, middle + side * 0.6, 43.0)
        chair(pen, middle + side * 0.6, 44.2)
    pen.rect(left, 48.4, right, 53.6)
    pen.clear(left + PARTITION, 48.4 + PARTITION, right - PARTITION, 50.9)
    pen.clear(left + PARTITION, 51.05, right - PARTITION, 53.6 - PARTITION)
    south_store = Pen(bitmap, (x0 + left + PARTITION, 48.54), (0, 1), (1, 0))
    door(south_store, 0.5, 1.0, PARTITION + 0.02, False)
    south_store.body(0.05, 1.9, 2.3, 2.55)
    north_store = Pen(bitmap, (x0 + right - PARTITION, 51.05), (0, 1), (-1, 0))
    door(north_store, 0.5, 1.0, PARTITION + 0.02)
    north_store.body(0.05, 1.9, 2.3, 2.55)
    # Trolleys in the corridors.
    for y in (34.0, 41.5, 47.0):
        pen.body(west + INNER + 0.05, y + 1.9, west + INNER + 0.5, y + 2.5)
        pen.body(east - INNER - 0.5, y - 0.8, east - INNER - 0.05, y - 0.2)
    # The day room.
    day = Pen(bitmap, (x0 + FACADE, last + PARTITION / 2))
    w = WARD_WIDTH - 2 * FACADE
    for side in (0, 1):
        u = 0 if side == 0 else w
        s = 1 if side == 0 else -1
        day.polygon([(u, 3.2), (u, 4.3), (u + s * 1.1, 4.3)], WALL)
        table(day, u + s * 3.0, 1.7, 0.5, 4)
        table(day, u + s * 7.6, 2.2, 0.5, 2)
        seats(day, u + s * 5.3 - 0.6, 3.7, 3, 1)
    for u in (3.4, 6.6, 9.8, 13.0):
        window(Pen(bitmap, (x0 + FACADE + u, DEPTH - FACADE), (1, 0), (0, -1)), 0, 2.2)


def hospital():
    bitmap = Bitmap(LENGTH, DEPTH, PIXELS_PER_M)
    pen = Pen(bitmap)
    pen.rect(0, 0, LENGTH, DEPTH)
    pen.clear(FACADE, FACADE, LENGTH - FACADE, DEPTH - FACADE)
    street(bitmap)
    departments(bitmap)
    entrance_hall(bitmap)
    faces = [FACADE, *(x for ward_x in WARDS for x in (ward_x, ward_x + WARD_WIDTH)), LENGTH - FACADE]
    for x0, x1 in zip(faces[::2], faces[1::2]):
        garden(bitmap, x0, x1, (x0 + x1) / 2)
    for x0 in WARDS:
        ward(bitmap, x0)
    return bitmap


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    hospital().write_png(os.path.join(here, "hospital.png"))

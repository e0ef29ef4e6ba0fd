"""A small world and a study of it, for tests of launchers."""

WORLD = {
    "troupe": 1, "title": "A room", "quit_time_s": 3,
    "types": {
        "wall": {"size_m": [0.2, 6.5, 1]},
        "wanderer": {
            "size_m": [0.31, 0.17, 0.2], "drive": {"kind": "diff", "localization": "odom"}, "controller": {"kind": "wander"},
            "sensors": [{"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1},
                         "transducers": [{"range_max_m": 3.3, "fov_deg": 170.5, "samples": 9}]}]}},
    "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 3.7, "heading_deg": 0.7}}],
    "populations": [{"name": "w", "type": "wanderer", "count": 40,
                     "place": {"rule": "uniform", "region_m": [[-3.3, -3.3], [3.3, 3.3]]}}],
}
STUDY = {"troupe_study": 1, "world": "room.json", "for_s": 1, "measures": ["stalls"],
         "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [5, 10]}],
         "seeds": {"from": 1, "count": 4}}

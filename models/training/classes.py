# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The indoor classes that the network knows, in order of id, and how other label sets map to them."""

# name, mobility (see models/README.md), colour as red, green, blue
CLASSES = (
    ('background', 'static', (90, 90, 90)),
    ('person', 'person', (220, 20, 60)),
    ('chair', 'movable', (255, 160, 0)),
    ('monitor', 'static', (30, 110, 255)),
    ('keyboard', 'movable', (120, 200, 255)),
    ('mouse', 'movable', (255, 255, 120)),
    ('book', 'movable', (180, 110, 60)),
    ('laptop', 'movable', (90, 60, 220)),
    ('bottle', 'movable', (0, 190, 190)),
    ('cup', 'movable', (0, 230, 120)),
    ('table', 'static', (150, 100, 50)),
)
NAMES = tuple(name for name, _, _ in CLASSES)
PERSON = NAMES.index('person')
IGNORE = 255  # pixels without a label: no loss, no score

# COCO names that differ from ours. All others are background, "unlabeled" is ignored.
COCO_ALIASES = {'tv': 'monitor', 'dining table': 'table', 'table-merged': 'table', 'desk-stuff': 'table'}


def label_of_coco(names_by_id):
    """@param names_by_id {COCO id: name}  @return 256-entry list: COCO id -> our id."""
    table = [IGNORE] * 256
    for coco_id, name in names_by_id.items():
        if name != 'unlabeled':
            ours = COCO_ALIASES.get(name, name)
            table[coco_id] = NAMES.index(ours) if ours in NAMES else 0
    return table

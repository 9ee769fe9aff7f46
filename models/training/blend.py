#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Blends the weights that a training began with and those it ended with (Wortsman et al., "Robust Fine-Tuning of Zero-Shot Models",
CVPR 2022): a short training learns its samples and forgets some of what the long one before it knew; half way there is more of both.

usage: blend.py BEFORE.pt AFTER.pt OUT.pt [--share 0.5]

AFTER is of train.py --from BEFORE; weights of unrelated trainings are worse together than each alone.
"""
import argparse

from bisenetv2 import TRAINING_HEADS
from network_file import load_checkpoint, save_checkpoint


def blend(before, after, share):
    """@param before, after  {name: tensor} of networks of the same widths  @param share  of the latter, 0 to 1
    @return the same without the heads that only training has. Ends the program if they do not fit."""
    before, after = ({name: w for name, w in weights.items() if not name.startswith(TRAINING_HEADS)} for weights in (before, after))
    other = [name for name in {**before, **after}
             if name not in before or name not in after or before[name].shape != after[name].shape]
    if other:
        raise SystemExit(f'the networks are of different widths: {other[0]} for one')
    return {name: before[name].lerp(w, share) if w.dtype.is_floating_point else w for name, w in after.items()}


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('before')
    parser.add_argument('after')
    parser.add_argument('out')
    parser.add_argument('--share', type=float, default=0.5, help='of AFTER, 0 to 1')
    args = parser.parse_args(argv)
    if not 0 <= args.share <= 1:
        parser.error(f'--share must be 0 to 1, not {args.share}')
    before, after = load_checkpoint(args.before), load_checkpoint(args.after)
    save_checkpoint(args.out, **{key: after[key] for key in ('head_channels', 'size', 'step')},
                    average=blend(before['average'], after['average'], args.share))
    print(f'{args.out}: {args.share:g} of {args.after}, {1 - args.share:g} of {args.before}')


if __name__ == '__main__':
    main()

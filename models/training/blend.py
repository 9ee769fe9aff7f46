#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Blends the weights that a training began with and those it ended with (Wortsman et al., "Robust Fine-Tuning of Zero-Shot Models",
CVPR 2022): a short training learns its samples and forgets some of what the long one before it knew; half way there is more of both.

usage: blend.py BEFORE.pt|BEFORE.onnx AFTER.pt OUT.pt [--share 0.5]

AFTER is of train.py --from BEFORE; weights of unrelated trainings are worse together than each alone.
"""
import argparse

from network_file import load_checkpoint, read_weights, save_checkpoint


def blend(before, after, share):
    """@param before, after  {name: tensor} of networks of the same widths  @param share  of the latter, 0 to 1
    @return the same. Ends the program if they do not fit."""
    blended = dict(after)
    for name, weights in blended.items():
        if weights.dtype.is_floating_point:
            if name not in before or before[name].shape != weights.shape:
                raise SystemExit(f'the networks are of different widths: {name} for one')
            blended[name] = before[name].lerp(weights, share)
    return blended


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('before', help='checkpoint, or network of export.py')
    parser.add_argument('after')
    parser.add_argument('out')
    parser.add_argument('--share', type=float, default=0.5, help='of AFTER, 0 to 1')
    args = parser.parse_args(argv)
    if not 0 <= args.share <= 1:
        parser.error(f'--share must be 0 to 1, not {args.share}')
    after = load_checkpoint(args.after)
    save_checkpoint(args.out, **{key: after[key] for key in ('size', 'step')},
                    average=blend(read_weights(args.before), after['average'], args.share))
    print(f'{args.out}: {args.share:g} of {args.after}, {1 - args.share:g} of {args.before}')


if __name__ == '__main__':
    main()

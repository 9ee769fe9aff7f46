# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""A progress bar, and the curve of a training as a picture."""
import csv
import sys
import time


class Bar:
    """One line that is rewritten on a terminal, and a line now and then elsewhere."""

    def __init__(self, done=0.0):
        """@param done  0 to 1"""
        self.first, self.start, self.shown = done, time.time(), 0.0

    def update(self, done, text):
        now = time.time()
        terminal = sys.stderr.isatty()
        if done < 1 and now - self.shown < (0.2 if terminal else 30):
            return
        self.shown = now
        left = ''
        if done - self.first > 0.001:  # a run that goes on knows nothing of the time before
            left = f', {_clock((now - self.start) / (done - self.first) * (1 - done))} left'
        filled = int(30 * done)
        line = f"[{'#' * filled}{'.' * (30 - filled)}] {100 * done:.1f} % {text}{left}"
        print(('\r' + line + '\x1b[K') if terminal else line, end='\n' if not terminal or done >= 1 else '',
              file=sys.stderr, flush=True)


def _clock(seconds):
    return f'{int(seconds) // 3600}:{int(seconds) // 60 % 60:02d}:{int(seconds) % 60:02d}'


def plot_curve(log_csv, picture):
    """Loss and validation IoU over the steps. Needs matplotlib; @return whether there was one."""
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    with open(log_csv, encoding='utf-8') as text:
        rows = list(csv.DictReader(text))
    figure, loss_axis = plt.subplots(figsize=(8, 4.5))
    loss_axis.plot([int(r['step']) for r in rows], [float(r['loss']) for r in rows], color='tab:blue', label='loss')
    loss_axis.set_xlabel('step')
    loss_axis.set_ylabel('training loss')
    iou_axis = loss_axis.twinx()
    for key, colour in (('person_iou', 'tab:red'), ('mean_iou', 'tab:orange')):
        scored = [r for r in rows if r[key]]
        iou_axis.plot([int(r['step']) for r in scored], [float(r[key]) for r in scored], 'o-', color=colour, label=key)
    iou_axis.set_ylim(0, 1)
    iou_axis.set_ylabel('IoU on the held-back fold')
    figure.legend(loc='upper center', ncol=3)
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return True

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""BiSeNet V2 (Yu et al., "BiSeNet V2: Bilateral Network with Guided Aggregation for Real-time Semantic Segmentation",
International Journal of Computer Vision 129, 2021), written from the paper. Table and figure numbers are the paper's."""
import torch
from torch import nn
import torch.nn.functional as F

from classes import PERSON

DETAIL_CHANNELS = (64, 64, 64, 64, 64, 128, 128, 128)  # of the detail branch's convolutions, S1-S3, table 1
DETAIL_STRIDES = (2, 1, 2, 1, 1, 2, 1, 1)
# Of the semantic branch, MobileNetV2's table 2: expansion, channels, blocks, stride of the first, dilation of the others
BLOCKS = ((1, 16, 1, 1, 1), (6, 24, 2, 2, 1), (6, 32, 3, 2, 1), (6, 64, 4, 2, 1), (6, 96, 3, 1, 1), (6, 160, 3, 1, 2), (6, 320, 1, 1, 2))
STEM_CHANNELS = 32
FEATURE_CHANNELS = BLOCKS[-1][1]
CONTEXT_CHANNELS = 256
EDGE_CELLS = 1                          # of TwoScales


class Conv(nn.Conv2d):
    """On a processor, bfloat16 is the slower choice for convolutions by groups: a tenth of float32's speed at stride 2."""

    def forward(self, x):
        if self.groups == 1 or x.dtype != torch.bfloat16 or x.device.type != 'cpu':
            return super().forward(x)
        with torch.autocast('cpu', enabled=False):
            return super().forward(x.float()).to(x.dtype)


def conv_bn(inputs, outputs, kernel=3, stride=1, groups=1, relu=True):
    layers = [Conv(inputs, outputs, kernel, stride, kernel // 2, groups=groups, bias=False),
              nn.BatchNorm2d(outputs)]
    return nn.Sequential(*layers, nn.ReLU(inplace=True)) if relu else nn.Sequential(*layers)


def depthwise(inputs, outputs, stride=1):
    """3x3 depth-wise convolution with batch normalisation; outputs is a multiple of inputs."""
    return conv_bn(inputs, outputs, 3, stride, groups=inputs, relu=False)


class DetailBranch(nn.Sequential):
    """Wide and shallow: spatial detail at 1/8. @param channels  of its eight convolutions"""

    def __init__(self, channels):
        inputs = (3, *channels[:-1])
        super().__init__(*[conv_bn(i, o, stride=stride) for i, o, stride in zip(inputs, channels, DETAIL_STRIDES)])


class InvertedResidual(nn.Module):
    """Expands, filters each channel, projects (Sandler et al., "MobileNetV2", CVPR 2018, figure 4)."""

    def __init__(self, inputs, outputs, expansion, stride, dilation):
        super().__init__()
        wide = expansion * inputs
        expand = [Conv(inputs, wide, 1), nn.ReLU6(inplace=True)] if expansion > 1 else []
        self.body = nn.Sequential(*expand, Conv(wide, wide, 3, stride, dilation, dilation, groups=wide), nn.ReLU6(inplace=True),
                                  Conv(wide, outputs, 1))
        self.residual = stride == 1 and inputs == outputs

    def forward(self, x):
        return x + self.body(x) if self.residual else self.body(x)


def mobilenet_v2():
    """Sandler et al., of width 1, its last stages dilated instead of shrunk: 320 channels at 1/16. Normalisations are part of the
    convolutions, as in the ready network that its weights come from (ready_network.py)."""
    layers, inputs = [Conv(3, STEM_CHANNELS, 3, 2, 1), nn.ReLU6(inplace=True)], STEM_CHANNELS
    for expansion, outputs, count, stride, dilation in BLOCKS:
        for k in range(count):
            narrows = outputs == 160 and k == 0  # where the stride was, filters reach as far as before
            layers.append(InvertedResidual(inputs, outputs, expansion, 1 if k else stride, 1 if narrows else dilation))
            inputs = outputs
    return nn.Sequential(*layers)


class ContextEmbedding(nn.Module):
    """Adds the image's mean feature to every place, figure 4 (b), as DeepLab v3 does (Chen et al., 2017): both are projected first."""

    def __init__(self, inputs, channels):
        super().__init__()
        self.local = nn.Sequential(Conv(inputs, channels, 1), nn.ReLU(inplace=True))
        self.mean = nn.Sequential(Conv(inputs, channels, 1), nn.ReLU(inplace=True))
        self.of_local = Conv(channels, channels, 1)
        self.of_mean = Conv(channels, channels, 1, bias=False)

    def forward(self, x):
        mean = self.mean(x.mean(dim=(2, 3), keepdim=True))
        return F.relu(self.of_local(self.local(x)) + self.of_mean(mean))


class SemanticBranch(nn.Module):
    """Narrow and deep. @return features and context at 1/16: 320 and 256 channels"""

    def __init__(self):
        super().__init__()
        self.features = mobilenet_v2()
        self.context = ContextEmbedding(FEATURE_CHANNELS, CONTEXT_CHANNELS)

    def forward(self, image):
        features = self.features(image)
        return features, self.context(features)


class GuidedAggregation(nn.Module):
    """Each branch gates the other at its own scale, figure 6. @param outputs  channels, as many as `channels` as published"""

    def __init__(self, channels, outputs):
        super().__init__()

        def separable():
            return nn.Sequential(depthwise(channels, channels), nn.Conv2d(channels, channels, 1, bias=False))

        self.semantic = conv_bn(CONTEXT_CHANNELS + FEATURE_CHANNELS, channels, 1)
        self.detail_keep = separable()
        self.detail_down = conv_bn(channels, channels, stride=2, relu=False)  # the semantic branch ends at 1/16, not 1/32
        self.semantic_up = conv_bn(channels, channels, relu=False)
        self.semantic_keep = separable()
        self.fuse = conv_bn(channels, outputs, relu=False)

    def forward(self, detail, context, features):
        size, semantic = detail.shape[2:], self.semantic(torch.cat((context, features), dim=1))
        gate = torch.sigmoid(resize(self.semantic_up(semantic), size))
        fine = self.detail_keep(detail) * gate
        coarse = self.detail_down(detail) * torch.sigmoid(self.semantic_keep(semantic))
        return self.fuse(fine + resize(coarse, size))


class Head(nn.Sequential):
    """Logits at the resolution of its input."""

    def __init__(self, inputs, hidden, classes):
        super().__init__(conv_bn(inputs, hidden), nn.Dropout2d(0.1), nn.Conv2d(hidden, classes, 1))


def resize(x, size):
    return F.interpolate(x, size=[int(size[0]), int(size[1])], mode='bilinear', align_corners=False)


class BiSeNetV2(nn.Module):
    """@param classes        logits per pixel
    @param head_channels  hidden width of the last head, 1024 as published
    @param detail         channels of the detail branch's convolutions, the last as published; narrow.py takes some away
    @param aggregated     channels that the last head reads; likewise

    In:  N x 3 x H x W, normalised, H and W multiples of 16.
    Out: logits N x classes x H/8 x W/8, the sum of the last head's and of the context's own, which are coarser and which the head
         corrects.
    """

    def __init__(self, classes, head_channels=1024, detail=DETAIL_CHANNELS, aggregated=DETAIL_CHANNELS[-1]):
        super().__init__()
        self.detail = DetailBranch(detail)
        self.semantic = SemanticBranch()
        self.aggregate = GuidedAggregation(DETAIL_CHANNELS[-1], aggregated)
        self.head = Head(aggregated, head_channels, classes)
        self.coarse = Conv(CONTEXT_CHANNELS, classes, 1)
        self.apply(_initialise)
        for last in (self.head[-1], self.coarse):
            nn.init.normal_(last.weight, std=0.01)  # all classes start about even

    def forward(self, image):
        detail, (features, context) = self.detail(image), self.semantic(image)
        logits = self.head(self.aggregate(detail, context, features))
        return logits + resize(self.coarse(context), logits.shape[2:])


class TwoScales(BiSeNetV2):
    """The network at inference with a second look, a quarter of its work, at the image at half its size, for people who are so near
    that they fill the view: there they are as large as those it has learnt. Not part of the paper; networks on several scales are
    (Chen et al., "Attention to Scale", CVPR 2016). H and W even multiples of 16."""

    def forward(self, image):
        return with_large_people(super().forward(image), super().forward(F.avg_pool2d(image, 2)))


def with_large_people(logits, half):
    """Makes a place a person where the image at half its size shows the inside of one: where the person's logit is above all others
    within EDGE_CELLS too. Edges and small people stay those of the whole image, for a cell of the half one is twice as wide and knows
    the place of an edge half as well.

    @param logits  N x classes x H x W  @param half  N x classes x about H/2 x W/2  @return logits"""
    margin = resize(half[:, PERSON:PERSON + 1] - _largest_other(half), logits.shape[2:])
    inside = -F.max_pool2d(-margin, 2 * EDGE_CELLS + 1, stride=1, padding=EDGE_CELLS)  # the least of the neighbourhood
    person = torch.maximum(logits[:, PERSON:PERSON + 1], _largest_other(logits) + inside)
    return torch.cat((logits[:, :PERSON], person, logits[:, PERSON + 1:]), dim=1)


def _largest_other(logits):
    """@return N x 1 x H x W, the largest logit but the person's"""
    return torch.cat((logits[:, :PERSON], logits[:, PERSON + 1:]), dim=1).amax(dim=1, keepdim=True)


def _initialise(module):
    if isinstance(module, nn.Conv2d):
        nn.init.kaiming_normal_(module.weight, mode='fan_out', nonlinearity='relu')
        if module.bias is not None:
            nn.init.zeros_(module.bias)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps doc/method.md and doc/architecture.md true: what they cite in back ticks must exist.

`src/core/x.cpp`, `include/...`, `test/...`   the file or folder is there
`src/core/x.cpp: function, Class::member`     and the file has these names
`group.key = 2.0`, `kConstant = 64`           a header or source has a value of that name and size
`Suite.Test`                                  a test under test/ has that name
Links of all documents lead to files, and to headings in them.
README's table of symptoms quotes what the code says, and its remedies are keys and launch arguments that exist.
"""
import glob
import os
import re
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DOCUMENTS = ("doc/method.md", "doc/architecture.md")
LINKING = DOCUMENTS + ("README.md", "CONTRIBUTING.md", "doc/nodes.md", "doc/benchmarks.md", "doc/place_recognition.md", "bags/README.md")
PLACES = r"(?:src|include|test|msg|cfg|launch|scripts|models|doc|cmake)/[\w./-]*"


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def sources(*folders, suffixes=(".h", ".cpp")):
    for folder in folders:
        for path in glob.glob(os.path.join(ROOT, folder, "**", "*"), recursive=True):
            if path.endswith(suffixes):
                yield os.path.relpath(path, ROOT)


def same_value(said, held):
    try:
        return float(said) == float(held.rstrip("F"))
    except ValueError:
        return said == held.strip('"')


class Documents(unittest.TestCase):
    def citations(self, pattern):
        """Yields (document, match) of every piece of code in back ticks, outside of blocks, that has the pattern."""
        for document in DOCUMENTS:
            text = re.sub(r"^```.*?^```", "", read(document), flags=re.DOTALL | re.MULTILINE)
            for code in re.findall(r"`([^`\n]+)`", text):
                match = re.fullmatch(pattern, code)
                if match:
                    yield document, match

    def test_files_and_functions_that_are_cited_exist(self):
        found = 0
        for document, match in self.citations(rf"({PLACES})(?:: (.+))?"):
            found += 1
            path, names = match.groups()
            with self.subTest(document=document, path=path, names=names):
                self.assertTrue(os.path.exists(os.path.join(ROOT, path)), f"{document} cites {path}: it is not there")
                text = read(path) if names else ""
                for name in names.split(", ") if names else ():
                    for part in name.split("::"):
                        self.assertRegex(text, rf"\b{re.escape(part)}\b", f"{document} cites {name} in {path}")
        self.assertGreater(found, 50, "the pattern of citations no longer fits the documents")

    def test_values_that_are_cited_are_the_defaults(self):
        held = {}
        for path in sources("include", "src"):
            for name, value in re.findall(r"\b(\w+) = ([\w.+-]+|\"[^\"]*\")[;,]", read(path)):
                held.setdefault(name, []).append(value)
        found = 0
        for document, match in self.citations(r"(?:\w+\.)*(\w+) = ([\w.-]+)"):
            found += 1
            name, value = match.groups()
            with self.subTest(document=document, name=name):
                self.assertTrue(any(same_value(value, each) for each in held.get(name, [])),
                                f"{document} says {name} = {value}, the code {held.get(name)}")
        self.assertGreater(found, 20, "the pattern of values no longer fits the documents")

    def test_tests_that_are_cited_exist(self):
        names = {".".join(match) for path in sources("test")
                 for match in re.findall(r"TEST(?:_F)?\((\w+), (\w+)\)", read(path))}
        for document, match in self.citations(r"[A-Z]\w+\.[A-Z]\w+"):
            with self.subTest(document=document):
                self.assertIn(match.group(), names, f"{document} cites a test that is not there")

    def test_symptoms_and_remedies_of_the_readme_exist(self):
        code = "".join(read(path) for path in sources("include", "src"))
        launch = "".join(read(path) for path in sources("launch", suffixes=(".launch",)))
        section = read("README.md").split("## When it is lost or slow", 1)[1].split("\n## ", 1)[0]
        rows = [row.strip("|").split("|") for row in section.splitlines() if row.startswith("| ")][1:]
        self.assertGreater(len(rows), 10)
        for symptom, _, remedy in rows:
            for quoted in re.findall(r"`([^`]+)`", symptom):
                for piece in re.split(r"TOPIC|\.\.\.|[\d.]+ ", quoted):
                    with self.subTest(symptom=quoted):
                        self.assertIn(piece.strip(), code)
            for given in re.findall(r"`([^`]+)`", remedy + symptom):
                argument = re.match(r"(\w+):=", given)
                key = re.fullmatch(r"~?([a-z]\w*(?:[./]\w+)*)(?:: \S+)?", given)
                with self.subTest(remedy=given):
                    if argument:
                        self.assertIn(f'name="{argument[1]}"', launch)
                    elif key and re.search(r"[_./]", key[1]) and not key[1].startswith(("slam_", "robot_", "enable_")):
                        self.assertIn(f'"{re.split("[./]", key[1])[-1]}"', code)

    def test_links_lead_somewhere(self):
        for document in LINKING:
            for target in re.findall(r"\]\(([^)\s]+)\)", read(document)):
                if "://" in target:
                    continue
                path, _, anchor = target.partition("#")
                with self.subTest(document=document, target=target):
                    place = os.path.normpath(os.path.join(os.path.dirname(document), path)) if path else document
                    self.assertTrue(os.path.exists(os.path.join(ROOT, place)), f"{document} links to {target}: it is not there")
                    if anchor:
                        headings = re.findall(r"^#+ (.+)$", read(place), flags=re.MULTILINE)
                        anchors = [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings]
                        self.assertIn(anchor, anchors, f"{document} links to {target}: {place} has no such heading")


if __name__ == "__main__":
    unittest.main()

"""What of an output may differ between two runs, and is taken out before two runs are compared.

Times, seconds, memory, dates, versions, the folder of the run and the program's own path; and the hash and size of a file
that holds one of these, or that is compressed, which become those of what is left.
"""
import base64
import gzip
import hashlib
import pathlib
import re
import subprocess

NUMBER = r"-?\d[\d.]*(?:[eE][-+]?\d+)?"
TEXT = {".json", ".tsv", ".csv", ".txt", ".html", ".md", ".toml", ".log", ".obj", ".vtp", ".gii", ".bidsignore"}
TABLE = re.compile(r"seconds|memory")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


class Mask:
    """Of runs in one folder. Inputs that the first program made are read by both, so both programs are known."""

    def __init__(self, programs, folder, mask_threads):
        self.words = {str(folder): "<folder>"}
        self.versions, self.libraries = set(), set()
        for program in programs:
            self.words |= {str(program): "<program>", str(pathlib.Path(program).resolve()): "<program>"}
            said = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
            first, _, libraries = said.partition("\n")
            self.versions.add(first.split()[-1])
            self.libraries |= {tuple(item.rsplit(" ", 1)) for item in libraries.strip().split(", ") if " " in item}
        self.mask_threads = mask_threads
        self.hashes = {}  # sha256 of a file as it is -> its path

    def learn(self, path):
        """Files that later reports may name by their hash."""
        self.hashes[sha256(path.read_bytes())] = path

    def of_file(self, path):
        """The bytes of a file that have to be the same."""
        data = path.read_bytes()
        if data[:2] == b"\x1f\x8b":
            return gzip.decompress(data)
        if path.suffix in TEXT or path.name in TEXT:
            text = data.decode("utf-8", "replace")
            return (self.of_table(text) if path.suffix == ".tsv" else self.of_text(text)).encode()
        return data

    def of_stream(self, text, timed):
        """stdout or stderr; `timed`: the lines on stdout end with seconds."""
        if timed:
            text = re.sub(r"(?m) +\d+\.\d+$", " <seconds>", text)
        return self.of_text(text)

    def of_table(self, text):
        rows = [line.split("\t") for line in text.split("\n")]
        hidden = [n for n, name in enumerate(rows[0]) if TABLE.search(name)]
        for row in rows[1:]:
            for n in hidden:
                if n < len(row) and row[n] != "n/a":
                    row[n] = f"<{rows[0][n]}>"
        return self.of_text("\n".join("\t".join(row) for row in rows))

    def of_text(self, text):
        for word, name in sorted(self.words.items(), key=lambda item: -len(item[0])):
            text = text.replace(word, name)
        text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(?:\.\d+)?Z?", "<date>", text)
        text = re.sub(r'"seconds"\s*:\s*\{[^}]*\}', lambda m: re.sub(r":(\s*)" + NUMBER, r":\1<seconds>", m[0]), text)
        text = re.sub(r'("\w*(?:seconds|memory)\w*"\s*:\s*)' + NUMBER, r"\1<masked>", text)
        for name, version in self.libraries:
            text = re.sub(rf'({re.escape(name)}"?[: ]+"?){re.escape(version)}(?![\w.])', r"\1<version>", text)
        for version in self.versions:
            text = re.sub(rf"(?<![\w.]){re.escape(version)}(?![\w.])", "<version>", text)
        if self.mask_threads:
            text = re.sub(r'("threads"\s*:\s*)\d+', r"\1<threads>", text)
            text = re.sub(r'("--threads"\s*,\s*)"\d+"', r"\1<threads>", text)
            text = re.sub(r"(--threads[ =]|\bthreads = )\d+", r"\1<threads>", text)
        # The page holds volumes and meshes, compressed.
        text = re.sub(r"H4sI[A-Za-z0-9+/=]{40,}", self.of_packed, text)
        # A record of an output: the hash, and mostly the size.
        return re.sub(r'\b([0-9a-f]{64})\b("\s*,\s*"bytes"\s*:\s*)?(\d+)?', self.of_record, text)

    @staticmethod
    def of_packed(match):
        return "<gz " + sha256(gzip.decompress(base64.b64decode(match[0]))) + ">"

    def of_record(self, match):
        path = self.hashes.get(match[1])
        if path is None:
            return match[0]
        data = self.of_file(path)
        return sha256(data) + (match[2] or "") + (str(len(data)) if match[3] else "")

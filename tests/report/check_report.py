#!/usr/bin/env python3
"""Makes a small batch and its page, opens the page from its file in headless Chromium and uses it.

    check_report.py PELLICLE FOLDER      screenshots are kept in FOLDER; exit code 77 when there is no Chromium
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from browser import Browser  # noqa: E402

PHANTOMS = {
    "bean": ["--shape", "bean", "--radius", "9", "--size", "40,36,32", "--snr", "8"],
    "egg": ["--shape", "ellipsoid", "--radius", "8", "--size", "40,40,24", "--spacing", "0.9,0.9,1.5", "--direction", "12,-20,30", "--snr", "8"],
}


def make_page(program, folder):
    for name, flags in PHANTOMS.items():
        subprocess.run([program, "phantom", "-o", folder, "--name", name, *flags], check=True, stdout=subprocess.DEVNULL)
    (folder / "broken.nii").write_bytes(b"no volume")
    rows = ["name,input,seed-sphere", 'bean,bean.nii.gz,"0,0,0,4"', "broken <b>,broken.nii,", 'egg,egg.nii.gz,"0,0,0,4; 10,9,8,2"',
            'weak,egg.nii.gz,"10,9,8,2"', 'egg 10,egg.nii.gz,"1,0,0,4"']
    (folder / "cases.csv").write_text("\n".join(rows) + "\n")
    batch = subprocess.run([program, "batch", "cases.csv", "-o", "out", "--keep-going", "--jobs", "2", "--detail", "1", "-q"], cwd=folder,
                           stdout=subprocess.DEVNULL)
    assert batch.returncode == 1, batch.returncode
    for page in ("report.html", "again.html"):
        subprocess.run([program, "report", "out", "-o", page, "--voxels", "40"], cwd=folder, check=True)
    assert (folder / "report.html").read_bytes() == (folder / "again.html").read_bytes(), "the page is not the same twice"
    return folder / "report.html"


def names(browser):
    return browser.run("[...document.querySelectorAll('#table tbody tr')].map(r => r.cells[1].textContent)")


def lit_share(browser):
    """Share of the viewer's pixels that are not its background, as the screen shows them."""
    return browser.run("""new Promise(done => requestAnimationFrame(() => {
      const from = document.getElementById('canvas'), to = document.createElement('canvas');
      window.dispatchEvent(new Event('resize'));
      requestAnimationFrame(() => {
        to.width = from.width; to.height = from.height;
        const pen = to.getContext('2d');
        pen.drawImage(from, 0, 0);
        const p = pen.getImageData(0, 0, to.width, to.height).data;
        let lit = 0;
        for (let i = 0; i < p.length; i += 4) if (Math.max(p[i], p[i + 1], p[i + 2]) > 40) ++lit;
        done(lit / (p.length / 4));
      });
    }))""")


def check(browser, page, pictures):
    browser.open(page)
    browser.wait_for("document.body && ['ready', 'none'].includes(document.body.dataset.viewer)")
    # Status first: the failed case leads, and it is the one that is shown.
    assert names(browser)[0] == "broken <b>", names(browser)
    assert "broken <b>" in browser.run("document.getElementById('name').textContent")
    assert browser.run("document.querySelectorAll('#counts .bad').length") >= 1
    # The table sorts by name, as people count, both ways; and by number with what has none at the end.
    browser.run("document.querySelectorAll('#table th button')[1].click()")
    up = names(browser)
    assert up == ["bean", "broken <b>", "egg", "egg 10", "weak"], up
    browser.run("document.querySelectorAll('#table th button')[1].click()")
    assert names(browser) == up[::-1], names(browser)
    browser.run("document.querySelectorAll('#table th button')[2].click()")
    volumes = browser.run("[...document.querySelectorAll('#table tbody tr')].map(r => parseFloat(r.cells[3].textContent))")
    known = [v for v in volumes if v is not None and v == v]
    assert known == sorted(known) and len(known) == 4, volumes
    assert names(browser)[-1] == "broken <b>"
    # A case with a mouse; the viewer draws it.
    browser.run("[...document.querySelectorAll('#table tbody tr')].find(r => r.cells[1].textContent === 'egg').click()")
    browser.wait_for("document.body.dataset.viewer === 'ready'")
    assert lit_share(browser) > 0.05, lit_share(browser)
    assert browser.run("document.querySelectorAll('#energies svg circle').length") > 3
    assert browser.run("document.querySelectorAll('#facts .facts').length") == 2  # two objects
    # And with keys: views, surface, next case, filter.
    browser.press("5")
    assert browser.run("document.querySelector('[data-view=render]').getAttribute('aria-pressed')") == "true"
    with_surface = lit_share(browser)
    assert with_surface > 0.02, with_surface
    browser.press("s")
    assert browser.run("document.getElementById('surface').getAttribute('aria-pressed')") == "false"
    browser.press("s")
    browser.press("1")
    before = browser.run("document.getElementById('name').firstChild.textContent")
    browser.press("j")
    browser.wait_for("document.body.dataset.viewer !== 'loading'")
    assert browser.run("document.getElementById('name').firstChild.textContent") != before
    browser.press("/")
    browser.run("document.getElementById('filter').value = 'bean'; document.getElementById('filter').dispatchEvent(new Event('input'))")
    assert names(browser) == ["bean"]
    browser.run("document.getElementById('filter').value = ''; document.getElementById('filter').dispatchEvent(new Event('input'))")
    browser.press("Escape")
    browser.run("[...document.querySelectorAll('#table tbody tr')].find(r => r.cells[1].textContent === 'bean').click()")
    browser.wait_for("document.body.dataset.viewer === 'ready'")
    lit_share(browser)
    browser.screenshot(pictures / "report.png")
    # A telephone: nothing sticks out sideways.
    browser.ask("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    browser.wait_for("innerWidth <= 400")
    assert browser.run("document.documentElement.scrollWidth <= innerWidth + 1"), browser.run("document.documentElement.scrollWidth")
    lit_share(browser)
    browser.screenshot(pictures / "report_phone.png")
    # Paper: a picture in the place of the viewer.
    browser.ask("Emulation.setEmulatedMedia", media="print")
    assert browser.run("getComputedStyle(document.getElementById('picture')).display") == "block"
    assert browser.run("getComputedStyle(document.getElementById('screen')).display") == "none"
    complaints = browser.complaints()
    assert not complaints, complaints


def main():
    program, pictures = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    if shutil.which("chromium") is None:
        print("skipped: chromium is not installed")
        return 77
    pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="pellicle-page-") as folder:
        page = make_page(program, pathlib.Path(folder))
        print(f"page: {page.stat().st_size / 1e6:.1f} MB")
        browser = Browser(1200, 1500)
        try:
            check(browser, page, pictures)
        finally:
            browser.screenshot(pictures / "last.png")
            browser.close()
    print("the page works; pictures are in", pictures)
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env bash
# Pictures of `pellicle report` for the documentation: the demo's brain, and a batch of twelve phantoms.
#   scripts/screenshots.sh      makes docs/images/report-demo.png and docs/images/report-batch.png
set -euo pipefail
cd "$(dirname "$0")/.."
program=$PWD/build/release/cli/pellicle
images=$PWD/docs/images
head=/usr/share/mricron/templates/ch2.nii.gz
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" segment -q -i "$head" -o "$work/demo" --preset brain-t1 --write mask,mesh,model,report,qc
"$program" report "$work/demo" -o "$work/demo.html"

# Twelve cases with different shapes, polarities and noise; one volume contains no object, one file is not a volume.
phantom() { "$program" phantom -q -o "$work" --size 56,56,56 --name "$@" >/dev/null; }
phantom bean --shape bean --radius 15 --snr 12
phantom bean-dark --shape bean --contrast 20,100 --radius 15 --snr 12
phantom bean-bias --shape bean --bias 0.3 --radius 15 --snr 12
phantom blob --shape blob --seed 5 --radius 15 --snr 12
phantom blob-bias --shape blob --bias 0.4 --radius 15 --snr 12
phantom blob-shell --shape blob --fill shell --seed 3 --radius 15
phantom egg --shape ellipsoid --radius 20,14,11 --snr 12
phantom egg-oblique --shape ellipsoid --radius 20,14,11 --spacing 0.9,0.9,1.6 --direction 12,-20,30 --snr 12
phantom sphere --shape sphere --radius 15 --snr 12
phantom box --shape superquadric --radius 15 --snr 12
phantom nothing --shape sphere --contrast 51,50 --snr 0.1 --radius 15
echo "no volume" >"$work/truncated.nii"
{
  echo "name,input,seed-sphere"
  for case in bean bean-dark bean-bias blob blob-bias blob-shell egg egg-oblique sphere box nothing; do
    echo "$case,$case.nii.gz,\"0,0,0,6\""
  done
  echo "truncated,truncated.nii,\"0,0,0,6\""
} >"$work/cases.csv"
(cd "$work" && "$program" batch cases.csv -o batch --keep-going --jobs 2 -q >/dev/null) || true  # exit code 1 is expected: a case fails
(cd "$work" && "$program" report batch -o batch.html --title "Twelve phantoms" --voxels 64)

PYTHONPATH=tests/report:scripts/pictures /usr/bin/python3 - "$work" "$images" <<'PY'
import pathlib
import sys

from browser import Browser
from smaller import make_smaller

work, images = map(pathlib.Path, sys.argv[1:])


def shoot(page, picture, height, case=None):
    browser = Browser(1200, height)
    try:
        browser.open(work / page)
        ready = "document.body && ['ready', 'none'].includes(document.body.dataset.viewer)"
        browser.wait_for(ready)
        if case is not None:
            browser.run(f"[...document.querySelectorAll('#table tbody tr')].find(r => r.cells[1].textContent === '{case}').click()")
            browser.wait_for("document.body.dataset.viewer === 'ready'")
            browser.run("scrollTo(0, 0)")
        # The page is not wider than the window, and the browser reports no errors.
        assert browser.run("document.documentElement.scrollWidth <= innerWidth")
        browser.run("new Promise(done => requestAnimationFrame(() => { dispatchEvent(new Event('resize')); requestAnimationFrame(done) }))")
        browser.screenshot(images / picture)
        complaints = browser.complaints()
        assert not complaints, complaints
        make_smaller(browser, images / picture)
    finally:
        browser.close()
    print(images / picture, (images / picture).stat().st_size // 1024, "KB")


shoot("demo.html", "report-demo.png", 1320)
shoot("batch.html", "report-batch.png", 1500, "bean")
PY

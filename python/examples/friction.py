"""Measures the friction of a unit, and names the missing effect: python friction.py [SERIAL]

Start a daemon first: jointbench serve
"""

import sys

import jointbench


def main(serial: str) -> None:
    with jointbench.connect() as lab:
        # With a lease the run ends in order if this program dies.
        run = lab.bench("joint-a-mock").run("friction", unit=serial, repeats=2, load_levels=1, lease=30)
        run.wait(progress=True)
        for quantity in run.result.quantities:
            interval = f" [{quantity.ci95[0]:.3g} … {quantity.ci95[1]:.3g}]" if quantity.ci95 else ""
            print(f"{quantity.title}: {quantity.value:.3g}{interval} {quantity.unit}")
        samples = run.to_polars()
        print(f"{samples.height} samples of {', '.join(samples.columns)}")
        diagnosis = run.diagnose()
        print(diagnosis.summary)
        diagnosis.plot().savefig(f"diagnosis-{run.id}.png")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "SN1")

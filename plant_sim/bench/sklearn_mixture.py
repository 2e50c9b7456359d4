"""The mixture search of bench_wear by scikit-learn's GaussianMixture. Progress on standard error, JSON on standard output.

python3 sklearn_mixture.py POINTS.csv STARTS COVARIANCE_FLOOR TOLERANCE MOST_COMPONENTS

POINTS.csv: x,y standardised, no header. TOLERANCE: gain of the mean log-likelihood a point below which EM ends.
"""

import json
import sys
import time
import warnings

import numpy
import sklearn
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture


def main() -> None:
    path, starts, floor, tolerance, most = sys.argv[1:]
    points = numpy.loadtxt(path, delimiter=",")
    warnings.simplefilter("ignore", ConvergenceWarning)
    rows = []
    for components in range(1, int(most) + 1):
        model = GaussianMixture(
            n_components=components,
            covariance_type="full",
            reg_covar=float(floor),
            n_init=int(starts),
            tol=float(tolerance),
            max_iter=20000,
            random_state=components,
        )
        wall, processor = time.perf_counter(), time.process_time()
        model.fit(points)
        rows.append(
            {
                "components": components,
                "log_likelihood": float(model.score(points)) * len(points),
                "seconds": time.perf_counter() - wall,
                "processor_s": time.process_time() - processor,
                "iterations_of_best": int(model.n_iter_),
                "converged": bool(model.converged_),
            }
        )
        print(f"scikit-learn: {components} components, {rows[-1]['seconds']:.1f} s", file=sys.stderr, flush=True)
    json.dump({"version": sklearn.__version__, "orders": rows}, sys.stdout)


main()

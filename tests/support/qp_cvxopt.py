# Quadratic programs through cvxopt, an independent interior-point solver.
#   /usr/bin/python3 qp_cvxopt.py PROGRAMS N     median CPU microseconds of N solutions of each, on
#                                                one thread, at cvxopt's own tolerances, matrices
#                                                sparse or dense: the faster
# min 1/2 |x - g|^2, rows a'x >= b. PROGRAMS is binary, numbers of this machine: how many programs;
# each: variables, rows, terms (all 64-bit integers); g; the terms' rows, their columns (integers),
# their factors; bounds (all else double).
import array
import os
import statistics
import sys
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"
try:
    from cvxopt import matrix, solvers, spmatrix
except ImportError:
    sys.exit(77)


def read(file, kind, count):
    numbers = array.array(kind)
    numbers.fromfile(file, count)
    return numbers


def read_program(file):
    n, rows, terms = read(file, "q", 3)
    hessian = spmatrix(1.0, range(n), range(n))
    linear = -matrix(read(file, "d", n), (n, 1))
    of_row, of_column, factors = read(file, "q", terms), read(file, "q",
                                                              terms), read(file, "d", terms)
    bounds = matrix(read(file, "d", rows), (rows, 1))
    normals = spmatrix(list(factors), list(of_row), list(of_column), (rows, n))
    return [hessian, linear, -normals, -bounds]


def seconds_of(problem):
    start = time.process_time()
    solvers.qp(*problem, options={"show_progress": False})
    return time.process_time() - start


def main():
    with open(sys.argv[1], "rb") as file:
        problems = [read_program(file) for _ in range(read(file, "q", 1)[0])]
    for problem in problems:
        dense = [matrix(part) for part in problem]
        medians = [statistics.median(seconds_of(p) for _ in range(int(sys.argv[2])))
                   for p in (problem, dense)]
        print(1e6 * min(medians))


main()

# Peer of the c51-step benchmarks: the same gradient step in PyTorch, vectorised, in the style of
# CleanRL's c51.py. It serves steps on request, so that they alternate with ours in one run: for
# each line on standard input it prints the milliseconds of one step. First line out: "ready" and
# the matrix library, or the reason why it does not run.
#   python3 c51_torch.py THREADS
import ctypes
import os
import sys
import time

try:
    import torch
except ImportError:
    print("python3-torch is not installed: tools/setup --bench", flush=True)
    sys.exit(1)

BATCH, REPLAY, ATOMS, ACTIONS, GAMMA, TAU = 16384, 1_000_000, 51, 3, 0.999, 0.1
V_MIN, V_MAX = -10.0, 10.0
STEP = (V_MAX - V_MIN) / (ATOMS - 1)



def blas():
    """Matrix library of this process, and the kernel of OpenBLAS."""
    with open("/proc/self/maps") as maps:
        paths = {line.split()[-1] for line in maps if ".so" in line}
    for path in sorted(paths):
        name = os.path.basename(path)
        real = os.path.realpath(path)
        if "mkl" in name:
            return "Intel MKL"
        if "openblas" in real:
            library = ctypes.CDLL(path)
            for function in (library.openblas_get_config, library.openblas_get_corename):
                function.restype = ctypes.c_char_p
            version = library.openblas_get_config().decode().split()[1]
            return f"OpenBLAS {version}, kernel {library.openblas_get_corename().decode()}"
    return "no optimised BLAS (install libopenblas0-openmp)"


torch.set_num_threads(int(sys.argv[1]))
torch.manual_seed(1)


def network():
    return torch.nn.Sequential(
        torch.nn.Linear(5, 256), torch.nn.ReLU(),
        torch.nn.Linear(256, 128), torch.nn.ReLU(),
        torch.nn.Linear(128, ACTIONS * ATOMS))


online, target = network(), network()
target.load_state_dict(online.state_dict())
optimiser = torch.optim.Adam(online.parameters(), lr=5e-4, foreach=True)
atoms = torch.linspace(V_MIN, V_MAX, ATOMS)
rows = torch.arange(BATCH)
row_offsets = (rows * ATOMS).view(BATCH, 1)

state, next_state = torch.rand(REPLAY, 5), torch.rand(REPLAY, 5)
action = torch.randint(0, ACTIONS, (REPLAY,))
reward = 0.1 * torch.randn(REPLAY, 1)
terminal = (torch.rand(REPLAY, 1) < 0.01).float()


@torch.no_grad()
def target_distribution(s, r, d):
    p = torch.softmax(target(s).view(BATCH, ACTIONS, ATOMS), 2)
    p = p[rows, torch.argmax(p @ atoms, 1)]
    b = ((r + GAMMA * (1 - d) * atoms).clamp_(V_MIN, V_MAX) - V_MIN).div_(STEP).clamp_(0, ATOMS - 1)
    lower = b.floor()
    share = b - lower
    lower = lower.long()
    upper = (lower + 1).clamp_(max=ATOMS - 1)
    m = torch.zeros(BATCH * ATOMS)
    m.index_add_(0, (lower + row_offsets).view(-1), (p * (1 - share)).view(-1))
    m.index_add_(0, (upper + row_offsets).view(-1), (p * share).view(-1))
    return m.view(BATCH, ATOMS)


def gradient_step():
    drawn = torch.randint(0, REPLAY, (BATCH,))
    s, s2, a, r, d = (t.index_select(0, drawn) for t in (state, next_state, action, reward,
                                                         terminal))
    m = target_distribution(s2, r, d)
    log_p = torch.log_softmax(online(s).view(BATCH, ACTIONS, ATOMS)[rows, a], 1)
    loss = -(m * log_p).sum(1).mean()
    optimiser.zero_grad(set_to_none=True)
    loss.backward()
    optimiser.step()
    targets = [p.data for p in target.parameters()]
    torch._foreach_mul_(targets, 1 - TAU)
    torch._foreach_add_(targets, [p.data for p in online.parameters()], alpha=TAU)


for _ in range(3):
    gradient_step()
print("ready", blas(), flush=True)
for _ in sys.stdin:
    start = time.perf_counter()
    gradient_step()
    print(1e3 * (time.perf_counter() - start), flush=True)

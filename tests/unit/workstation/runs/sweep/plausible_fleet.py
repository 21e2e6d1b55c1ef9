#!/usr/bin/env python3
"""Plausible fleet: sites with the powers and capacities of catalogues, for sweep plan.

    tests/unit/workstation/runs/sweep/plausible_fleet.py [SITES [measured]] > sites.csv

Homes are a manufacturer's capacities with the inverters sold for them, the rest cabinets and
containers; five contracts and two pairs of thresholds. With `measured` each capacity is that of an
aged battery, 85 to 100 % of the catalogue's, so hardly two sites share a C-rate.
Drawn by the seed "plausible fleet".
"""
import random
import sys

# Usable kWh, kW, number out of 104.
CATALOGUE = [
    ([13.5], [5, 11.5], 15),
    ([5, 10, 15, 20, 30], [2.5, 5, 10], 14),
    ([5.1, 7.7, 10.2, 12.8], [5, 6, 8, 10], 10),
    ([8.3, 11.0, 13.8, 16.6, 19.3, 22.1], [5, 6, 8, 10, 12], 10),
    ([9.6, 12.8, 16, 19.2, 22.4, 25.6], [5, 6, 8, 10], 12),
    ([5.0, 10.0, 11.0, 15.0, 22.0], [2.5, 3.3, 4.6], 10),
    ([5.1, 8.2, 10.1, 13.3, 16.4, 20.2], [3, 5, 6, 8, 10], 8),
    ([6.5, 9.8, 10, 16], [3.3, 5, 7], 6),
    ([3.2, 6.4, 9.6, 12.8, 16.0, 19.2, 22.4, 25.6], [3, 3.6, 5, 8, 10], 8),
    ([7.1, 9.5, 10, 12.5], [2.5, 3.75, 4.5], 6),
    ([100, 200, 215, 232, 261], [50, 60, 92, 100, 105, 120, 125], 4),
    ([1000, 2000, 2150, 2500, 3440, 3727, 5015], [500, 1000, 1250, 1720, 2500], 1),
]
IMPORT_EUR_PER_MWH = [0, 2, 5, 10, 20]
THRESHOLDS = ["0,300", "-50,250"]

count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
is_measured = sys.argv[2:] == ["measured"]
draw = random.Random("plausible fleet")
print("id,battery.power_w,battery.capacity_wh,costs.import_adder_eur_per_mwh,"
      "correction.low_price_eur_per_mwh,correction.high_price_eur_per_mwh")
for number in range(1, count + 1):
    capacities, powers, _ = draw.choices(CATALOGUE, [weight for *_, weight in CATALOGUE])[0]
    capacity_kwh, power_kw = draw.choice(capacities), draw.choice(powers)
    power_kw = min(power_kw, capacity_kwh)  # no more than 1 C is sold
    if is_measured:
        capacity_kwh = round(capacity_kwh * draw.uniform(0.85, 1), 2)
    print(f"site-{number},{power_kw * 1000:g},{capacity_kwh * 1000:g},"
          f"{draw.choice(IMPORT_EUR_PER_MWH)},{draw.choice(THRESHOLDS)}")

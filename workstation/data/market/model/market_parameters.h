// Fitted parameters of the simulated market.
//
// Source: Elia open data (CC BY 4.0), settled quarter-hours of 1 January to 23 May 2023 (dataset
// ods047, 13,650 rows), minute system imbalance of 1 January 2023 (ods045) and the minute prices of
// 6 September 2024 and 8 April 2025 (ods161).
//
// Model. Three scores (SI, MIP, MDP), each approximately standard normal: daily profile in local
// time + season + weekend + effect of the imbalance on the marginal prices + autoregressions.
// Within a simulated year the rank of a score selects a quantile (ladder step) in MW or EUR/MWh:
// every year has the sample's distribution, and the seed affects only the order. Fit: the sample's
// normal scores (rank -> normal quantile) were regressed on hour means, month means and the hinges
// max(0, -SI) and max(0, SI) of this and the preceding quarter-hour; the autoregressions were
// matched to the residuals' autocorrelation (lags 1 to 288). The ladders are the sample's
// quantiles.
//
// June to December are an extrapolation: the sample has January to May of one year with falling
// prices, so the season (a cosine) has about two thirds of the slope of those months.
#pragma once

#include <array>

namespace bess {

using HourlyProfile = std::array<double, 24>;  ///< value at the middle of each local hour

/// Stochastic part of a score: sum of autoregressions on the quarter-hour grid.
struct Autoregression {
  double share;        ///< of the stochastic variance
  double correlation;  ///< at lag 1
};

struct ScoreParameters {
  HourlyProfile profile;
  double winter;     ///< amplitude of cos(2 pi (day of year - 15) / 365)
  double midday;     ///< extra at 11-15 h local in midsummer, none in midwinter (solar surplus)
  double weekend;    ///< added on Saturday and Sunday
  double deviation;  ///< standard deviation of the stochastic part
  std::array<Autoregression, 3> autoregressions;
};

inline constexpr ScoreParameters kImbalanceScore{
    .profile = {0.02, 0.09, 0.13, 0.16, 0.14, 0.05,  -0.16, -0.14, -0.11, 0.04,  0.04,  -0.02,
                0.16, 0.18, 0.17, 0.10, 0.11, -0.15, -0.28, -0.30, -0.29, -0.22, -0.17, 0.08},
    .winter = 0.0,
    .midday = 0.2,
    .weekend = 0.0,
    .deviation = 0.94,
    .autoregressions = {{{0.50, 0.30}, {0.36, 0.87}, {0.14, 0.995}}}};

inline constexpr ScoreParameters kIncrementalScore{
    .profile = {-0.11, -0.11, -0.19, -0.31, -0.33, -0.30, -0.13, 0.16, 0.23, 0.15, 0.12, 0.00,
                -0.02, -0.12, -0.14, -0.12, -0.15, 0.06,  0.30,  0.51, 0.37, 0.18, 0.09, -0.04},
    .winter = 0.5,
    .midday = -0.1,
    .weekend = -0.13,
    .deviation = 0.78,
    .autoregressions = {{{0.50, 0.30}, {0.30, 0.95}, {0.20, 0.99}}}};

inline constexpr ScoreParameters kDecrementalScore{
    .profile = {-0.12, -0.08, -0.04, -0.01, -0.03, 0.01, 0.08, 0.11, 0.19, 0.03, -0.11, -0.06,
                -0.05, -0.12, -0.08, -0.04, 0.08,  0.10, 0.18, 0.16, 0.09, 0.01, 0.09,  -0.10},
    .winter = 0.45,
    .midday = -0.3,
    .weekend = -0.32,
    .deviation = 0.85,
    .autoregressions = {{{0.36, 0.25}, {0.20, 0.95}, {0.44, 0.995}}}};

/// Effect of the imbalance on a marginal price's score, per 166 MW (its standard deviation).
struct ImbalancePull {
  double shortage_now, shortage_before, surplus_now, surplus_before;
};
/// Upward bids answer shortages of this and the preceding quarter-hour, downward bids surpluses.
inline constexpr ImbalancePull kIncrementalPull{0.142, 0.541, -0.142, 0.082};
inline constexpr ImbalancePull kDecrementalPull{0.267, -0.138, -0.349, -0.254};
inline constexpr double kImbalanceUnitMw = 166;

/// Quantile of the sample: `value` is not exceeded with this probability.
struct LadderStep {
  double probability, value;
};

/// Shape of the path to the settled price, fitted to the median error by minute of the two ods161
/// days.
struct MinutePathParameters {
  double imbalance_deviation_mw;     ///< of the instantaneous SI around its quarter-hour mean path
  double imbalance_correlation;      ///< from minute to minute
  double first_bid_gap_eur_per_mwh;  ///< mean distance of the first activated bid from the last
  double reach_minutes;  ///< the last bid comes at minute reach * U^(1/4), U uniform: mostly late
  double step_probability;  ///< per minute, of a further bid on the way
};
/// On 1 January 2023: step deviation 50 MW, lag-1 correlation 0.97 including the quarter-hour's own
/// level; on the ods161 days the mean of minute 0 differs by 82 to 95 MW from the final one.
inline constexpr MinutePathParameters kMinutePath{.imbalance_deviation_mw = 130,
                                                  .imbalance_correlation = 0.93,
                                                  .first_bid_gap_eur_per_mwh = 35,
                                                  .reach_minutes = 15,
                                                  .step_probability = 0.2};

/// System imbalance, MW, of all quarter-hours; 58.6 % of them are short.
inline constexpr std::array<LadderStep, 36> kImbalanceLadder{
    {{0, -1149.7},   {0.001, -787.1}, {0.0025, -681.2}, {0.005, -596.8}, {0.01, -510.5},
     {0.02, -414.5}, {0.035, -351.0}, {0.05, -310.7},   {0.075, -264.4}, {0.1, -230.7},
     {0.15, -183.6}, {0.2, -151.2},   {0.25, -123.5},   {0.3, -100.1},   {0.35, -79.1},
     {0.4, -60.0},   {0.45, -43.0},   {0.5, -27.1},     {0.55, -12.0},   {0.58564, 0.0},
     {0.6, 4.3},     {0.65, 19.9},    {0.7, 36.8},      {0.75, 57.5},    {0.8, 81.0},
     {0.85, 110.9},  {0.9, 152.3},    {0.925, 179.3},   {0.95, 218.3},   {0.965, 254.5},
     {0.98, 300.6},  {0.99, 370.5},   {0.995, 461.6},   {0.9975, 559.7}, {0.999, 707.4},
     {1, 1127.8}}};

/// MIP, EUR/MWh, of the 7,994 quarter-hours in which Belgium was short; the last half percent is
/// scarcity (25 January, 20, 27 and 28 March, 2 April, 14 May).
inline constexpr std::array<LadderStep, 38> kIncrementalLadder{
    {{0, 14.0},       {0.001, 55.0},    {0.005, 60.0},   {0.01, 90.1},    {0.02, 109.2},
     {0.035, 113.1},  {0.05, 116.2},    {0.075, 120.6},  {0.1, 127.7},    {0.15, 137.5},
     {0.2, 145.5},    {0.25, 153.7},    {0.3, 161.6},    {0.35, 170.0},   {0.4, 176.0},
     {0.45, 184.9},   {0.5, 195.2},     {0.55, 203.8},   {0.6, 211.9},    {0.65, 220.3},
     {0.7, 232.4},    {0.75, 247.0},    {0.8, 264.5},    {0.85, 279.0},   {0.9, 297.1},
     {0.925, 308.9},  {0.95, 326.8},    {0.965, 350.0},  {0.98, 377.9},   {0.99, 430.3},
     {0.995, 593.8},  {0.9965, 620.8},  {0.9975, 945.2}, {0.998, 1001.4}, {0.9985, 1450.0},
     {0.999, 1718.3}, {0.9995, 2000.0}, {1, 3455.7}}};

/// MDP, EUR/MWh, of the 5,656 quarter-hours with a surplus.
inline constexpr std::array<LadderStep, 32> kDecrementalLadder{
    {{0, -543.3},    {0.0005, -498.2}, {0.001, -483.5}, {0.0025, -439.2}, {0.005, -407.8},
     {0.01, -365.3}, {0.02, -309.5},   {0.035, -258.6}, {0.05, -223.0},   {0.075, -168.0},
     {0.1, -148.7},  {0.15, -94.1},    {0.2, -84.0},    {0.25, -56.2},    {0.3, -32.3},
     {0.35, -19.6},  {0.4, -15.1},     {0.45, -10.3},   {0.5, 0.1},       {0.55, 15.0},
     {0.6, 34.2},    {0.65, 49.4},     {0.7, 59.1},     {0.75, 66.5},     {0.8, 70.0},
     {0.85, 72.7},   {0.9, 76.0},      {0.95, 81.7},    {0.98, 86.0},     {0.99, 89.3},
     {0.9975, 96.9}, {1, 105.0}}};

}  // namespace bess

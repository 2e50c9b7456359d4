#include "rig_bridge/wear/em_pass.hpp"

#include <cmath>

#include "rig_bridge/wear/fast_exp.hpp"

namespace wear {

namespace {

using Lanes = std::array<double, kLanes>;

[[gnu::always_inline]] inline double total(const Lanes& lanes) {
    double sum = 0.0;
    for (const double lane : lanes) sum += lane;
    return sum;
}

struct Sums {
    Lanes n{}, x{}, y{}, xx{}, xy{}, yy{};
};

/// Log densities of one component at a block's points, and the greatest so far.
[[gnu::always_inline]] inline void log_densities(const double* x, const double* y, const Whitened& c, double* out, double* greatest) {
    for (std::size_t i = 0; i < kBlock; ++i) {
        const double dx = x[i] - c.mx;
        const double z1 = dx * c.i11;
        const double z2 = dx * c.i21 + (y[i] - c.my) * c.i22;
        const double value = c.level - 0.5 * (z1 * z1 + z2 * z2);
        out[i] = value;
        greatest[i] = greatest[i] > value ? greatest[i] : value;
    }
}

[[gnu::always_inline]] inline void add_moments(const double* x, const double* y, const double* share, const double* scale, const Whitened& c,
                                               Sums& sums) {
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const double r = share[i + lane] * scale[i + lane];
            const double dx = x[i + lane] - c.mx;
            const double dy = y[i + lane] - c.my;
            const double rx = r * dx;
            const double ry = r * dy;
            sums.n[lane] += r;
            sums.x[lane] += rx;
            sums.y[lane] += ry;
            sums.xx[lane] += rx * dx;
            sums.xy[lane] += rx * dy;
            sums.yy[lane] += ry * dy;
        }
    }
}

/// Sum over a block of log(sum of densities): by log-sum-exp, and one logarithm for the product of all 64 sums, each within 1 to M.
[[gnu::always_inline]] inline double log_of(const double* greatest, const double* sum, const double* there) {
    Lanes levels{};
    Lanes product;
    product.fill(1.0);
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            levels[lane] += there[i + lane] * greatest[i + lane];
            product[lane] *= there[i + lane] > 0.0 ? sum[i + lane] : 1.0;
        }
    }
    double all = 1.0;
    for (const double lane : product) all *= lane;
    return total(levels) + std::log(all);
}

[[gnu::always_inline]] inline void whole_pass(const StandardPoints& points, const Whitened* components, std::size_t count, Pass& out) {
    alignas(64) std::array<std::array<double, kBlock>, kMaxSearched> share{};
    alignas(64) std::array<double, kBlock> greatest{};
    alignas(64) std::array<double, kBlock> sum{};
    alignas(64) std::array<double, kBlock> scale{};
    alignas(64) std::array<Sums, kMaxSearched> sums{};
    double log_likelihood = 0.0;
    for (std::size_t b = 0; b < points.blocks(); ++b) {
        const double* x = points.x() + b * kBlock;
        const double* y = points.y() + b * kBlock;
        const double* there = points.there() + b * kBlock;
        greatest.fill(-1e300);
        for (std::size_t j = 0; j < count; ++j) log_densities(x, y, components[j], share[j].data(), greatest.data());
        sum.fill(0.0);
        for (std::size_t j = 0; j < count; ++j) {
            double* e = share[j].data();
            for (std::size_t i = 0; i < kBlock; ++i) {
                e[i] = exp_not_positive(e[i] - greatest[i]);
                sum[i] += e[i];
            }
        }
        for (std::size_t i = 0; i < kBlock; ++i) scale[i] = there[i] / sum[i];
        for (std::size_t j = 0; j < count; ++j) add_moments(x, y, share[j].data(), scale.data(), components[j], sums[j]);
        log_likelihood += log_of(greatest.data(), sum.data(), there);
    }
    for (std::size_t j = 0; j < count; ++j) {
        const Sums& s = sums[j];
        out.moments[j] = {total(s.n), total(s.x), total(s.y), total(s.xx), total(s.xy), total(s.yy)};
    }
    out.log_likelihood = log_likelihood;
}

#if defined(__x86_64__)
[[gnu::target("avx512f,avx512dq,avx512vl")]] void pass_avx512(const StandardPoints& points, const Whitened* components, std::size_t count,
                                                              Pass& out) {
    whole_pass(points, components, count, out);
}

[[gnu::target("avx2")]] void pass_avx2(const StandardPoints& points, const Whitened* components, std::size_t count, Pass& out) {
    whole_pass(points, components, count, out);
}
#endif

}  // namespace

void pass(const StandardPoints& points, const Whitened* components, std::size_t count, Pass& out) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return pass_avx512(points, components, count, out);
    if (__builtin_cpu_supports("avx2")) return pass_avx2(points, components, count, out);
#endif
    whole_pass(points, components, count, out);
}

}  // namespace wear

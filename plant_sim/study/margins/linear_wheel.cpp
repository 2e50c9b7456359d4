#include "plant_sim/study/margins/linear_wheel.hpp"

#include <numbers>

#include "plant_sim/study/margins/dense.hpp"

namespace study::margins {

std::vector<Complex> LinearWheel::poles() const {
    return eigenvalues(a);
}

std::vector<Complex> LinearWheel::zeros() const {
    if (a.rows() == 1) return {};
    return eigenvalues(Eigen::MatrixXd(a.bottomRightCorner(a.rows() - 1, a.cols() - 1)));
}

std::optional<Complex> LinearWheel::swing() const {
    std::optional<Complex> fastest;
    for (const Complex& p : poles())
        if (p.imag() > 0.0 && (!fastest || p.real() > fastest->real())) fastest = p;
    return fastest;
}

LinearWheel linear_wheel(const OperatingPoint& at, Linearisation linearisation) {
    const rig::RingParameters& ring = at.ring;
    const bool swings = ring.belt_share > 0.0, relaxes = at.relaxation_m > 0.0;
    if (!swings && !relaxes) return {.a = Eigen::MatrixXd::Constant(1, 1, -at.wheel_pole_radps(linearisation)), .gain = 1.0};
    const Eigen::Index belt = swings ? 1 : 0, twist = 2, tread = swings ? 3 : 1;
    const Eigen::Index slips = relaxes ? tread : belt;  // state whose slip determines the road's force
    LinearWheel w{.a = Eigen::MatrixXd::Zero(tread + (relaxes ? 1 : 0), tread + (relaxes ? 1 : 0)), .gain = 1.0 / (1.0 - ring.belt_share)};

    // The road's force acts on the wheel or its belt, and decelerates the aircraft.
    const double per_slip = at.load_N * at.mu_1 / (at.mass_kg * at.speed_mps);
    const double on_wheel = per_slip * at.mass_kg * at.radius_m * at.radius_m / at.inertia_kgm2;
    const double aircraft = linearisation == Linearisation::full ? at.load_N * at.mu / (at.mass_kg * at.speed_mps) : 0.0;
    w.a(belt, slips) -= on_wheel / (swings ? ring.belt_share : 1.0);
    for (Eigen::Index i = 0; i <= belt; ++i) {
        w.a(i, slips) -= (1.0 - at.slip) * per_slip;
        w.a(i, i) += aircraft;
    }
    if (swings) {
        // The carcass acts on rim and belt with opposite torques; accelerations are inversely proportional to the inertias.
        const double own = 2.0 * std::numbers::pi * ring.frequency_Hz;
        const Eigen::RowVector3d pull{-2.0 * ring.damping * own, 2.0 * ring.damping * own, own};
        w.a.row(0).head<3>() += ring.belt_share * pull;
        w.a.row(belt).head<3>() -= (1.0 - ring.belt_share) * pull;
        w.a.row(twist).head<3>() << -own, own, 0.0;
    }
    if (relaxes) {
        w.a(tread, belt) += at.speed_mps / at.relaxation_m;
        w.a(tread, tread) -= at.speed_mps / at.relaxation_m;
    }
    return w;
}

}  // namespace study::margins

// The same law with Pinocchio's terms and Eigen's factorisations: what its
// documentation suggests for M, C, g, J and dJ/dt, fixed sizes everywhere else.
// LEVELS is 1 (flange, 3 rows) or 2 (and wrist, 2 rows).

#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <memory>

#include "peer.h"

namespace pin = pinocchio;
constexpr int N = 7, M = LEVELS == 1 ? 3 : 5;
using Joints = Eigen::Matrix<double, N, 1>;
using Square = Eigen::Matrix<double, N, N>;
using Rows = Eigen::Matrix<double, M, N>;
using Column = Eigen::Matrix<double, M, 1>;

static pin::Model model;
static std::unique_ptr<pin::Data> data;
static pin::FrameIndex frames[2];
static Joints limit;

void peer_setup(const std::vector<double>& arm) {
    auto next = arm.begin();
    const auto number = [&] { return *next++; };
    const auto vector = [&] {
        const double x = number(), y = number(), z = number();
        return Eigen::Vector3d(x, y, z);
    };
    model.gravity = pin::Motion(vector(), Eigen::Vector3d::Zero());
    pin::SE3 placement(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(0.0, 0.0, number()));
    const double flange = number();
    pin::JointIndex parent = 0;
    for (int i = 0; i < N; ++i) {
        parent = model.addJoint(parent, pin::JointModelRZ(), placement, "joint" + std::to_string(i));
        const double alpha = number(), a = number(), d = number(), mass = number();
        const Eigen::Vector3d com = vector();
        const Eigen::Vector3d x = vector(), y = vector();
        Eigen::Matrix3d tensor, turn;
        tensor << x[0], x[1], x[2], x[1], y[0], y[1], x[2], y[1], y[2];
        turn = Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()).toRotationMatrix();
        placement = pin::SE3(turn, Eigen::Vector3d(a, 0.0, d));
        model.appendBodyToJoint(parent, pin::Inertia(mass, com, tensor), placement);
        limit[i] = number();
        if (i == 6) {
            const pin::SE3 end(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(0.0, 0.0, flange));
            frames[0] = model.addFrame(pin::Frame("flange", parent, 0, placement * end, pin::OP_FRAME));
        } else if (i == 4) {
            frames[1] = model.addFrame(pin::Frame("wrist", parent, 0, placement, pin::OP_FRAME));
        }
    }
    data = std::make_unique<pin::Data>(model);
}

template <int R, int C = 1>
static Eigen::Map<const Eigen::Matrix<double, R, C>> take(const double*& in) {
    const double* start = in;
    in += R * C;
    return Eigen::Map<const Eigen::Matrix<double, R, C>>(start);
}

/// Rows and commanded acceleration of one level, from row `at` on.
template <int R>
static void level(int at, pin::FrameIndex frame, const Joints& dq, const double*& in, Rows& j, Rows& jdot, Column& b) {
    const auto x = take<R>(in), dx = take<R>(in), ddx = take<R>(in);
    const auto kp = take<R, R>(in), kd = take<R, R>(in);
    Eigen::Matrix<double, 6, N> full, rate;
    full.setZero();
    rate.setZero();
    pin::updateFramePlacement(model, *data, frame);
    pin::getFrameJacobian(model, *data, frame, pin::LOCAL_WORLD_ALIGNED, full);
    pin::getFrameJacobianTimeVariation(model, *data, frame, pin::LOCAL_WORLD_ALIGNED, rate);
    j.template middleRows<R>(at) = full.template topRows<R>();
    jdot.template middleRows<R>(at) = rate.template topRows<R>();
    const Eigen::Matrix<double, R, 1> speed = full.template topRows<R>() * dq;
    const Eigen::Matrix<double, R, 1> place = data->oMf[frame].translation().template head<R>();
    b.template segment<R>(at) = ddx + kd * (dx - speed) + kp * (x - place) - rate.template topRows<R>() * dq;
}

void peer_step(const double* in, double* out) {
    const Joints q = take<N>(in), dq = take<N>(in), q_d = take<N>(in);
    const auto stiffness = take<N, N>(in), damping = take<N, N>(in);
    const auto before = take<N>(in), input = take<N>(in), last = take<N>(in), gain = take<N>(in);
    const double h = *in++;

    pin::computeJointJacobiansTimeVariation(model, *data, q, dq);
    pin::crba(model, *data, q, pin::Convention::WORLD);
    const Square c = pin::computeCoriolisMatrix(model, *data, q, dq);
    const Joints g = pin::computeGeneralizedGravity(model, *data, q);
    const Square m = data->M.selfadjointView<Eigen::Upper>();

    Rows j, jdot;
    Column b;
    level<3>(0, frames[0], dq, in, j, jdot, b);
    if constexpr (LEVELS == 2) level<2>(3, frames[1], dq, in, j, jdot, b);

    const Joints momentum = m * dq;
    const Joints decay = (-gain * h).array().exp();
    const Joints innovation = (momentum - before) / h - input;
    const Joints r = decay.array() * last.array() + (1.0 - decay.array()) * innovation.array();

    const Eigen::LLT<Square> cholesky(m);
    const auto lower = cholesky.matrixL();
    const auto upper = cholesky.matrixU();
    const Eigen::Matrix<double, N, M> a = lower.solve(j.transpose());
    const Eigen::HouseholderQR<Eigen::Matrix<double, N, M>> qr(a);
    const auto rotation = qr.householderQ();
    // A^T = Q R: R^T is lower triangular, by rows in order of priority.
    const Eigen::Matrix<double, M, M> factor = qr.matrixQR().template topRows<M>();
    const auto pivots = factor.template triangularView<Eigen::Upper>();

    Joints s = upper * dq;
    s = rotation.adjoint() * s;
    s.template tail<N - M>().setZero();
    const Column force = pivots.solve(s.template head<M>());
    Joints w = rotation * s;
    w = upper.solve(w);
    const Joints free = stiffness * (q_d - q) - damping * (dq - w) - c * dq - c.transpose() * w + jdot.transpose() * force;
    Joints task = lower.solve(r), null = lower.solve(free);
    task = rotation.adjoint() * task;
    null = rotation.adjoint() * null;
    const Column y = pivots.transpose().solve(b);
    null.template head<M>() = y - task.template head<M>();
    null = rotation * null;
    const Joints demand = lower * null;
    const Joints bias = c * dq + g;
    const Joints torque = (demand + bias).cwiseMax(-limit).cwiseMin(limit);

    Eigen::Map<Eigen::Matrix<double, N, 4>> result(out);
    result << torque, r, momentum, torque + c.transpose() * dq - g;
}

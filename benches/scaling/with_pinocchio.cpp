// Pinocchio's functions behind the calling convention of measure.cpp, for the models of `pinocchio_read`.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>

#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

using namespace pinocchio;
using Vector = Eigen::Map<const Eigen::VectorXd>;

namespace {
struct Robot {
    Model model;
    Data data;
};
std::vector<std::unique_ptr<Robot>> robots;

// A joint by its kind, its axis where it has one.
JointIndex joint(Model &model, JointIndex parent, const std::string &kind, const SE3 &place, const std::string &name) {
    if (kind == "free") return model.addJoint(parent, JointModelFreeFlyer(), place, name);
    if (kind == "turn_x") return model.addJoint(parent, JointModelRX(), place, name);
    if (kind == "turn_y") return model.addJoint(parent, JointModelRY(), place, name);
    if (kind == "turn_z") return model.addJoint(parent, JointModelRZ(), place, name);
    throw std::runtime_error("no joint for " + kind);
}

struct Parts {
    Vector q, v, tau;
    Parts(const Model &model, const double *x)
        : q(x, model.nq), v(x + model.nq, model.nv), tau(x + model.nq + model.nv, model.nv) {}
};

template <class Matrix> void copy(const Matrix &matrix, double *&out) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows>(out, matrix.rows(), matrix.cols()) = matrix;
    out += matrix.size();
}
}  // namespace

// Reads robots: number of links, gravity, then by link kind, parent, rotation, place, mass, centre, inertia.
void pinocchio_read(const char *path) {
    std::ifstream in(path);
    int links;
    double gravity;
    while (in >> links >> gravity) {
        Model model;
        model.gravity.linear() = Eigen::Vector3d(0, 0, -gravity);
        std::vector<JointIndex> joints;
        for (int i = 0; i < links; i++) {
            std::string kind;
            int parent;
            Eigen::Matrix3d rotation, inertia;
            Eigen::Vector3d place, centre;
            double mass;
            in >> kind >> parent;
            for (int k = 0; k < 9; k++) in >> rotation(k / 3, k % 3);
            for (int k = 0; k < 3; k++) in >> place[k];
            in >> mass;
            for (int k = 0; k < 3; k++) in >> centre[k];
            for (int k = 0; k < 9; k++) in >> inertia(k / 3, k % 3);
            joints.push_back(joint(model, parent < 0 ? 0 : joints[parent], kind, SE3(rotation, place), std::to_string(i)));
            model.appendBodyToJoint(joints.back(), Inertia(mass, centre, inertia), SE3::Identity());
        }
        Data data(model);
        robots.push_back(std::make_unique<Robot>(Robot{model, data}));
    }
}

// Accelerations, in the faster of the two conventions; they stay in the data where `out` is null.
void pinocchio_rates(int robot, const double *x, double *out) {
    Robot &r = *robots[robot];
    const Parts parts(r.model, x);
    aba(r.model, r.data, parts.q, parts.v, parts.tau, Convention::WORLD);
    if (out) copy(r.data.ddq, out);
}

// Accelerations and their derivatives by configuration, velocity and torque.
void pinocchio_jacobians(int robot, const double *x, double *out) {
    Robot &r = *robots[robot];
    const Parts parts(r.model, x);
    computeABADerivatives(r.model, r.data, parts.q, parts.v, parts.tau);
    if (!out) return;
    copy(r.data.ddq, out);
    copy(r.data.ddq_dq, out);
    copy(r.data.ddq_dv, out);
    copy(r.data.Minv, out);
}

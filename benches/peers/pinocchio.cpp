// CPU time of Pinocchio's regressor and inverse dynamics, ns a sample, medians over rounds of a JSON line each.
//
//     pinocchio_times MODEL [ROUNDS]
//
// MODEL is the text that compare.py writes: one line per joint with the axis (x, y or z), the placement in the parent frame
// (rotation row by row, translation), mass, centre of mass and rotational inertia about it. The joints are the specialised
// ones (JointModelRX and so on) and everything is compiled here for this machine, which is the fastest Pinocchio there is
// short of generated code.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/regressor.hpp>

#include <ctime>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <vector>

namespace pin = pinocchio;

static double cpu_ns()
{
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec * 1e9 + time.tv_nsec;
}

static pin::Model read_model(const char * path)
{
  pin::Model model;
  std::ifstream file(path);
  std::string line;
  pin::JointIndex parent = 0;
  while (std::getline(file, line))
  {
    std::istringstream in(line);
    char axis;
    pin::SE3 placement;
    double mass;
    Eigen::Vector3d centre;
    Eigen::Matrix3d tensor;
    in >> axis;
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        in >> placement.rotation()(r, c);
    for (int r = 0; r < 3; r++)
      in >> placement.translation()(r);
    in >> mass >> centre(0) >> centre(1) >> centre(2);
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        in >> tensor(r, c);
    const std::string name = "joint" + std::to_string(parent + 1);
    if (axis == 'x')
      parent = model.addJoint(parent, pin::JointModelRX(), placement, name);
    else if (axis == 'y')
      parent = model.addJoint(parent, pin::JointModelRY(), placement, name);
    else
      parent = model.addJoint(parent, pin::JointModelRZ(), placement, name);
    model.appendBodyToJoint(parent, pin::Inertia(mass, centre, tensor), pin::SE3::Identity());
  }
  return model;
}

int main(int count, char ** arguments)
{
  const int samples = 2000, rounds = count > 2 ? std::atoi(arguments[2]) : 5;
  pin::Model model = read_model(arguments[1]);
  pin::Data data(model);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::vector<Eigen::VectorXd> q, v, a;
  for (auto * signals : {&q, &v, &a})
    for (int k = 0; k < samples; k++)
      signals->push_back(Eigen::VectorXd::NullaryExpr(model.nv, [&] { return uniform(random); }));
  double sum = 0;
  for (int round = 0; round < rounds; round++)
  {
    double start = cpu_ns();
    for (int k = 0; k < samples; k++)
      sum += pin::computeJointTorqueRegressor(model, data, q[k], v[k], a[k])(0, 0);
    const double regressor = (cpu_ns() - start) / samples;
    start = cpu_ns();
    for (int k = 0; k < samples; k++)
      sum += pin::rnea(model, data, q[k], v[k], a[k])(0);
    const double rnea = (cpu_ns() - start) / samples;
    std::cout << "{\"regressor\": " << regressor << ", \"inverse dynamics\": " << rnea << "}" << std::endl;
  }
  return sum == 0.123;
}

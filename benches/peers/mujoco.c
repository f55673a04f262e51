// CPU time of a forward step of MuJoCo in C, ns, one JSON line a round.
//
//     mujoco_times MODEL.xml [ROUNDS]
#include <mujoco/mujoco.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double cpu_ns(void)
{
  struct timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec * 1e9 + time.tv_nsec;
}

static double steps(const mjModel * model, mjData * data, void (*run)(const mjModel *, mjData *))
{
  const int count = 5000;
  mj_resetData(model, data);
  const double start = cpu_ns();
  for (int k = 0; k < count; k++)
    run(model, data);
  return (cpu_ns() - start) / count;
}

int main(int count, char ** arguments)
{
  char error[500] = "";
  mjModel * model = mj_loadXML(arguments[1], NULL, error, sizeof error);
  if (!model)
  {
    fprintf(stderr, "%s\n", error);
    return 1;
  }
  mjData * data = mj_makeData(model);
  const int rounds = count > 2 ? atoi(arguments[2]) : 5;
  for (int round = 0; round < rounds; round++)
  {
    model->opt.integrator = mjINT_EULER;
    const double step = steps(model, data, mj_step);
    const double forward = steps(model, data, mj_forward);
    model->opt.integrator = mjINT_RK4;
    const double rk4 = steps(model, data, mj_step);
    printf("{\"mj_forward\": %g, \"mj_step\": %g, \"mj_step RK4\": %g}\n", forward, step, rk4);
  }
  return 0;
}

/* Hooks of the simulated Phantom library, in addition to the exported functions of the vendor's
 * library: the operator, injected faults, stepped time, and the true state. C functions, for dlsym.
 * SI units: m, s, N, Nm, rad, kg.
 *
 * The environment variable VOXTOUCH_HD_SIM sets the initial settings. It is read at the first call
 * of any function:
 *
 *     VOXTOUCH_HD_SIM="virtual=1;model=omni;grip=pen-firm;seed=7;coulomb_nm=0.02"
 *
 * Functions that return int return 0 on success and -1 on failure; hdsim_last_message() then
 * returns the reason. */
#ifndef VOXTOUCH_DEVICES_PHANTOM_SIMULATED_HDSIM_H
#define VOXTOUCH_DEVICES_PHANTOM_SIMULATED_HDSIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- Settings, for a device that is not initiated. Each power-cycles the device: time 0, not
 * calibrated, no faults. */

int hdsim_power_cycle(void);          /* settings are kept */
int hdsim_defaults(void);             /* defaults, without the environment variable */
int hdsim_use_virtual_time(int on);   /* no thread: only hdsim_step advances time */
int hdsim_set_model(const char* key); /* "premium", "premium-6dof", "desktop", "omni" */
int hdsim_set_seed(uint64_t seed);    /* of the hand's tremor */
/* "coulomb_nm", "viscous_nms_per_rad", "gravity_m_per_s2", "hand_bandwidth_hz", "resolution_m",
 * "gimbal_resolution_rad", "velocity_filter_hz", "thermal_time_s", "watchdog_s",
 * "reset_error_turret_rad", "..._thigh_rad", "..._shin_rad" */
int hdsim_set_number(const char* name, double value);

/* --- The operator; at any time. At time 0 the arm is moved to the start of the motion; later a new
 * motion starts with the call. Frame D of the device: +x right, +y up, +z towards the operator,
 * origin at the reset pose. */

/* Both take the text of a hand file (devices/operator/hand_file.hpp). The first uses its motion,
 * the second its grip with tremor. */
int hdsim_set_motion(const char* hand_file);
int hdsim_set_hand(const char* hand_file);

/* Buttons: bit 0 is the first. Initially the safety switch is pressed and the inkwell is empty.
 * Without the safety switch the motors give no torque. */
int hdsim_set_switches(int buttons, int safety, int inkwell);

/* --- Time */

/* One tick: callbacks, then one period of the arm. Requires virtual time and a started scheduler.
 * Returns 1 for a tick without callbacks (skipped, or stopped by a timer error). */
int hdsim_step(void);

/* --- Faults */

typedef enum hdsim_fault {
  HDSIM_COMM_ERROR = 1, /* amount: ticks; 0 ends it, negative: permanent. Samples freeze, commands
                           are lost, and the amplifier's watchdog ends the held force */
  HDSIM_DEVICE_FAULT,   /* amount as above. Motors turn off at once */
  HDSIM_TIMER_ERROR,    /* the servo loop stops: no callbacks until the scheduler is stopped and
                           started */
  HDSIM_WARM_MOTORS,    /* amount: new temperature of the motors; 1 is overheated */
  HDSIM_LATE_TICK,      /* amount: delay of the next tick [s]; the last force is held */
  HDSIM_SKIPPED_TICKS,  /* amount: ticks without callbacks */
  HDSIM_FAIL_INIT,      /* amount: error code of the next hdInitDevice */
  HDSIM_FAIL_START,     /* the next hdStartScheduler fails with a timer error */
  HDSIM_NAN_POSITION    /* amount: ticks with NaN positions; negative: permanent */
} hdsim_fault;
int hdsim_inject(int fault, double amount); /* fault: one of the above */

/* --- State that a real device does not report */

typedef struct hdsim_state {
  double time; /* of the arm since power-on, s */
  double tip[3], tip_velocity[3];
  double joints[3], joint_rates[3]; /* turret to the right, thigh up, shin up */
  double orientation[4];            /* of the stylus, w x y z */
  double motor_torque[3];           /* over the last substep, after all limits */
  double motor_force[3];            /* equivalent force at the tip */
  double hand_force[3];             /* of the operator's springs at the tip */
  double hand_target[3];
  double temperature[3];
  double energy;                           /* of the arm, J */
  uint64_t ticks, ticks_without_callbacks; /* since power-on */
  uint64_t non_finite_sets;                /* refused attempts to set NaN or Inf */
  uint32_t errors_waiting, callbacks;
  int held, scheduler_running, virtual_time, device_open;
} hdsim_state;
int hdsim_read_state(hdsim_state* state, size_t size); /* size: sizeof(hdsim_state) */

const char* hdsim_last_message(void); /* of this thread; empty if nothing has failed */

#ifdef __cplusplus
}
#endif
#endif

/* Hooks of the simulated Phantom library, next to the functions that it exports in the vendor's
 * place: the operator, faults on command, time that a test steps, and the true state. C, to be
 * found with dlsym. SI units: m, s, N, Nm, rad, kg.
 *
 * The environment variable VOXTOUCH_HD_SIM sets what the library starts from, read at the first
 * call of any function: VOXTOUCH_HD_SIM="virtual=1;model=omni;grip=pen-firm;seed=7;coulomb_nm=0.02"
 *
 * Functions that return int: 0 for done, -1 where it could not be; hdsim_last_message() then says
 * why. */
#ifndef VOXTOUCH_DEVICES_PHANTOM_SIMULATED_HDSIM_H
#define VOXTOUCH_DEVICES_PHANTOM_SIMULATED_HDSIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- Before a device is initiated. Each of these switches the device off and on again: time 0, not
 * calibrated, no faults. */

int hdsim_power_cycle(void);          /* settings are kept */
int hdsim_defaults(void);             /* settings as they are without environment variable */
int hdsim_use_virtual_time(int on);   /* no thread: time passes in hdsim_step only */
int hdsim_set_model(const char* key); /* "premium", "premium-6dof", "desktop", "omni" */
int hdsim_set_seed(uint64_t seed);    /* of the hand's tremor */
/* "coulomb_nm", "viscous_nms_per_rad", "gravity_m_per_s2", "hand_bandwidth_hz", "resolution_m",
 * "gimbal_resolution_rad", "velocity_filter_hz", "thermal_time_s", "watchdog_s",
 * "reset_error_turret_rad", "..._thigh_rad", "..._shin_rad" */
int hdsim_set_number(const char* name, double value);

/* --- The operator; at any time. Before the first tick the arm stands where the motion starts;
 * after it a new motion starts with the call. Frame D of the device: +x right, +y up, +z towards
 * the operator, origin at the reset pose. */

/* Each takes the text of a hand file (devices/operator/hand_file.hpp), and of it the motion, or the
 * grip with its tremor. */
int hdsim_set_motion(const char* hand_file);
int hdsim_set_hand(const char* hand_file);

/* Buttons: bit 0 the first. The safety switch is held at first; without it motors give nothing. The
 * inkwell is empty. */
int hdsim_set_switches(int buttons, int safety, int inkwell);

/* --- Time */

/* One tick: callbacks, then one period of the arm. Virtual time and a started scheduler only. 1:
 * the tick passed, but without callbacks (skipped, or the scheduler has died of a timer error). */
int hdsim_step(void);

/* --- Faults */

typedef enum hdsim_fault {
  HDSIM_COMM_ERROR = 1, /* amount: ticks; 0 ends it, negative: for good. Samples stand still, no
                           force gets through, and the amplifier's watchdog ends what it held */
  HDSIM_DEVICE_FAULT,   /* amount as above. Motors off at once */
  HDSIM_TIMER_ERROR, /* the servo loop dies: no callback any more until the scheduler is stopped and
                        started */
  HDSIM_WARM_MOTORS, /* amount: temperature that the motors have now, 1 is too hot */
  HDSIM_LATE_TICK, /* amount: seconds that the next tick comes late; the last force stands meanwhile
                    */
  HDSIM_SKIPPED_TICKS, /* amount: ticks without callbacks */
  HDSIM_FAIL_INIT,     /* amount: error code of the next hdInitDevice */
  HDSIM_FAIL_START,    /* the next hdStartScheduler fails with a timer error */
  HDSIM_NAN_POSITION   /* amount: ticks with positions that are not numbers; negative: for good */
} hdsim_fault;
int hdsim_inject(int fault, double amount); /* fault: one of the above */

/* --- What no real device reports */

typedef struct hdsim_state {
  double time; /* of the arm since power-on, s */
  double tip[3], tip_velocity[3];
  double joints[3], joint_rates[3]; /* turret to the right, thigh up, shin up */
  double orientation[4];            /* of the stylus, w x y z */
  double motor_torque[3];           /* over the last substep, after all limits */
  double motor_force[3];            /* what that comes to at the tip */
  double hand_force[3];             /* of the operator's springs at the tip */
  double hand_target[3];
  double temperature[3];
  double energy;                           /* of the arm, J */
  uint64_t ticks, ticks_without_callbacks; /* since power-on */
  uint64_t non_finite_sets; /* NaN or Inf that a person tried to set; each was refused */
  uint32_t errors_waiting, callbacks;
  int held, scheduler_running, virtual_time, device_open;
} hdsim_state;
int hdsim_read_state(hdsim_state* state, size_t size); /* size: sizeof(hdsim_state) */

const char* hdsim_last_message(void); /* of this thread; empty if nothing has failed */

#ifdef __cplusplus
}
#endif
#endif

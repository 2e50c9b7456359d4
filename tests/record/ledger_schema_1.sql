PRAGMA application_id = 1095978055;
PRAGMA user_version = 1;
BEGIN TRANSACTION;
CREATE TABLE campaigns (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    scenario TEXT NOT NULL,
    seed INTEGER NOT NULL,
    planned INTEGER NOT NULL CHECK (planned >= 0),
    config_hash TEXT NOT NULL,
    version TEXT NOT NULL,
    created TEXT NOT NULL
) STRICT;
INSERT INTO "campaigns" VALUES(1,'endurance','endurance',3,2,'f2ccebc747a6d7950dfbcd3331b745bd','0.1.0','1970-01-01T00:00:00Z');
CREATE TABLE maneuvers (
    id INTEGER PRIMARY KEY,
    campaign INTEGER NOT NULL REFERENCES campaigns (id),
    number INTEGER NOT NULL CHECK (number >= 1),
    attempt INTEGER NOT NULL CHECK (attempt >= 1),
    state TEXT NOT NULL CHECK (state IN ('running', 'finished', 'aborted', 'unfinished')),
    folder TEXT NOT NULL,
    scenario TEXT NOT NULL,
    outcome TEXT,
    started TEXT NOT NULL,
brake_on_mps REAL,
duration_s REAL,
length_m REAL,
mean_torque_Nm REAL,
mean_load_N REAL,
mean_pressure_Pa REAL,
mean_friction REAL,
energy_brake_J REAL,
energy_tyre_J REAL,
kinetic_energy_J REAL,
j_mu REAL,
peak_temperature_C REAL,
    standstill INTEGER CHECK (standstill IN (0, 1)),
    cumulative_energy_J REAL,
    faults TEXT,
    frames INTEGER,
    frames_dropped INTEGER,
    seed INTEGER NOT NULL,
    version TEXT NOT NULL,
    config_hash TEXT NOT NULL,
    UNIQUE (campaign, number, attempt)
) STRICT;
INSERT INTO "maneuvers" VALUES(1,1,1,1,'finished','endurance/0001','endurance','finished','1970-01-01T00:00:00Z',5.47814191818110387535e+01,1.6859957780937520511e+01,4.62965571257213696302e+02,6.31355197806945852775e+02,2.37995276882825055513e+04,9340617.59235882,3.00552788819357874494e-01,9.68989557341294130334e+05,2.81502634475328886772e+03,9.72420351937842322546e+05,7.3684674263381072512e-02,2.56200012207031249992e+02,1,9.68989557341294130334e+05,'',0,0,3,'0.1.0','f2ccebc747a6d7950dfbcd3331b745bd');
INSERT INTO "maneuvers" VALUES(2,1,2,1,'finished','endurance/0002','endurance','finished','1970-01-01T00:12:30Z',5.4918325734640568215e+01,1.71096098358397057386e+01,4.70861065474202291616e+02,6.24024650991808698579e+02,2.34593704136359556297e+04,9.21925115902589261546e+06,0.30097502752032,9.74047640666774706876e+05,2.71681072842528874397e+03,9.77273235623534535995e+05,7.3864032116637376446e-02,2.93799987792968750003e+02,1,1.94303719800806883729e+06,'',0,0,3,'0.1.0','f2ccebc747a6d7950dfbcd3331b745bd');
CREATE UNIQUE INDEX finished_once ON maneuvers (campaign, number) WHERE state = 'finished';
CREATE UNIQUE INDEX one_running ON maneuvers (campaign) WHERE state = 'running';
COMMIT;

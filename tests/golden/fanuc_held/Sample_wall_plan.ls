/PROG  Sample_wall_plan
/ATTR
OWNER = MNEDITOR;
COMMENT = "millpose";
PROTECT = READ_WRITE;
TCD:  STACK_SIZE = 0,
      TASK_PRIORITY = 50,
      TIME_SLICE = 0,
      BUSY_LAMP_OFF = 0,
      ABORT_REQUEST = 0,
      PAUSE_REQUEST = 0;
DEFAULT_GROUP = 1,*,*,*,*;
CONTROL_CODE = 00000000 00000000;
/MN
   1:  !written by millpose for FANUC ;
   2:  !job: Sample wall-plan ;
   3:  !cell: kr500_r2830 ;
   4:  !inputs: 0123456789abcdef ;
   5:  UFRAME_NUM=1 ;
   6:  UTOOL_NUM=2 ;
   7:J P[1] 20% FINE ;
   8:J P[2] 20% FINE ;
   9:  !PASS 0 PIECE 0 ;
  10:J P[3] 20% FINE ;
  11:  AO[1]=7000 ;
  12:  DO[1]=ON ;
  13:L P[4] 8cm/min FINE ;
  14:L P[5] 8cm/min CNT0 ;
  15:L P[6] 8cm/min CNT0 ;
  16:L P[7] 8cm/min FINE ;
  17:L P[8] 8cm/min FINE ;
  18:  !END OF PASS 0 PIECE 0 ;
  19:  !PASS 1 PIECE 0 ;
  20:J P[9] 20% FINE ;
  21:L P[10] 8cm/min FINE ;
  22:L P[11] 8cm/min CNT0 ;
  23:L P[12] 8cm/min CNT0 ;
  24:L P[13] 8cm/min FINE ;
  25:L P[14] 8cm/min FINE ;
  26:  !END OF PASS 1 PIECE 0 ;
  27:  DO[1]=OFF ;
  28:J P[15] 20% FINE ;
  29:J P[16] 20% FINE ;
/POS
P[1]{
   GP1:
    UF : 1, UT : 2,
    J1 = 0.000 deg, J2 = 0.000 deg, J3 = 0.000 deg,
    J4 = 0.000 deg, J5 = 0.000 deg, J6 = 0.000 deg
};
P[2]{
   GP1:
    UF : 1, UT : 2,
    J1 = -5.000 deg, J2 = -5.000 deg, J3 = -5.000 deg,
    J4 = 10.000 deg, J5 = -20.000 deg, J6 = -10.000 deg
};
P[3]{
   GP1:
    UF : 1, UT : 2,
    J1 = -14.855 deg, J2 = 55.542 deg, J3 = -71.938 deg,
    J4 = -83.383 deg, J5 = -116.401 deg, J6 = 70.453 deg
};
P[4]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -6.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[5]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -2.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.573 deg
};
P[6]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 2.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[7]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 6.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.427 deg
};
P[8]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 6.000 mm, Y = -4.000 mm, Z = 50.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.427 deg
};
P[9]{
   GP1:
    UF : 1, UT : 2,
    J1 = -14.614 deg, J2 = 54.975 deg, J3 = -71.632 deg,
    J4 = -83.767 deg, J5 = -116.360 deg, J6 = 70.104 deg
};
P[10]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 6.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[11]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 2.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.573 deg
};
P[12]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -2.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[13]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -6.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.427 deg
};
P[14]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -6.000 mm, Y = 4.000 mm, Z = 50.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.427 deg
};
P[15]{
   GP1:
    UF : 1, UT : 2,
    J1 = -5.000 deg, J2 = -5.000 deg, J3 = -5.000 deg,
    J4 = 10.000 deg, J5 = -20.000 deg, J6 = -10.000 deg
};
P[16]{
   GP1:
    UF : 1, UT : 2,
    J1 = 0.000 deg, J2 = 0.000 deg, J3 = 0.000 deg,
    J4 = 0.000 deg, J5 = 0.000 deg, J6 = 0.000 deg
};
/END

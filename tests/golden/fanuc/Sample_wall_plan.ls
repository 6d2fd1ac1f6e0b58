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
   5:  PR[90]=LPOS ;
   6:  PR[90,1]=2076.000 ;
   7:  PR[90,2]=30.000 ;
   8:  PR[90,3]=(-39.000) ;
   9:  PR[90,4]=0.000 ;
  10:  PR[90,5]=(-90.000) ;
  11:  PR[90,6]=0.000 ;
  12:  UFRAME[1]=PR[90] ;
  13:  PR[90]=LPOS ;
  14:  PR[90,1]=250.000 ;
  15:  PR[90,2]=0.000 ;
  16:  PR[90,3]=250.000 ;
  17:  PR[90,4]=0.000 ;
  18:  PR[90,5]=(-90.000) ;
  19:  PR[90,6]=0.000 ;
  20:  UTOOL[2]=PR[90] ;
  21:  UFRAME_NUM=1 ;
  22:  UTOOL_NUM=2 ;
  23:J P[1] 20% FINE ;
  24:J P[2] 20% FINE ;
  25:  !PASS 0 PIECE 0 ;
  26:J P[3] 20% FINE ;
  27:  AO[1]=7000 ;
  28:  DO[1]=ON ;
  29:L P[4] 8cm/min FINE ;
  30:L P[5] 8cm/min CNT0 ;
  31:L P[6] 8cm/min CNT0 ;
  32:L P[7] 8cm/min CNT0 ;
  33:L P[8] 8cm/min CNT0 ;
  34:L P[9] 8cm/min FINE ;
  35:L P[10] 8cm/min FINE ;
  36:  !END OF PASS 0 PIECE 0 ;
  37:  !PASS 1 PIECE 0 ;
  38:J P[11] 20% FINE ;
  39:L P[12] 8cm/min FINE ;
  40:L P[13] 8cm/min CNT0 ;
  41:L P[14] 8cm/min CNT0 ;
  42:L P[15] 8cm/min CNT0 ;
  43:L P[16] 8cm/min CNT0 ;
  44:L P[17] 8cm/min FINE ;
  45:L P[18] 8cm/min FINE ;
  46:  !END OF PASS 1 PIECE 0 ;
  47:  !PASS 2 PIECE 0 ;
  48:J P[19] 20% FINE ;
  49:L P[20] 8cm/min FINE ;
  50:L P[21] 8cm/min CNT0 ;
  51:L P[22] 8cm/min CNT0 ;
  52:L P[23] 8cm/min CNT0 ;
  53:L P[24] 8cm/min CNT0 ;
  54:L P[25] 8cm/min CNT0 ;
  55:L P[26] 8cm/min CNT0 ;
  56:L P[27] 8cm/min CNT0 ;
  57:L P[28] 8cm/min CNT0 ;
  58:L P[29] 8cm/min CNT0 ;
  59:L P[30] 8cm/min CNT0 ;
  60:L P[31] 8cm/min CNT0 ;
  61:L P[32] 8cm/min FINE ;
  62:L P[33] 8cm/min FINE ;
  63:  !END OF PASS 2 PIECE 0 ;
  64:  DO[1]=OFF ;
  65:J P[34] 20% FINE ;
  66:J P[35] 20% FINE ;
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
    J1 = -14.855 deg, J2 = 55.722 deg, J3 = -72.071 deg,
    J4 = -83.317 deg, J5 = -116.385 deg, J6 = 70.601 deg
};
P[4]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -10.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[5]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -6.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[6]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -2.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[7]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 2.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[8]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 6.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[9]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 10.000 mm, Y = -4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[10]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 10.000 mm, Y = -4.000 mm, Z = 50.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[11]{
   GP1:
    UF : 1, UT : 2,
    J1 = -14.614 deg, J2 = 54.794 deg, J3 = -71.495 deg,
    J4 = -83.834 deg, J5 = -116.375 deg, J6 = 69.952 deg
};
P[12]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 10.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[13]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 6.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[14]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 2.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[15]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -2.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[16]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -6.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[17]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -10.000 mm, Y = 4.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[18]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -10.000 mm, Y = 4.000 mm, Z = 50.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[19]{
   GP1:
    UF : 1, UT : 2,
    J1 = -14.735 deg, J2 = 54.356 deg, J3 = -71.102 deg,
    J4 = -83.912 deg, J5 = -116.455 deg, J6 = 69.521 deg
};
P[20]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 20.000 mm, Y = 0.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[21]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 17.321 mm, Y = 10.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.286 deg
};
P[22]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 10.000 mm, Y = 17.321 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[23]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 0.000 mm, Y = 20.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.573 deg
};
P[24]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -10.000 mm, Y = 17.321 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.496 deg
};
P[25]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -17.321 mm, Y = 10.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.286 deg
};
P[26]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -20.000 mm, Y = 0.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[27]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -17.321 mm, Y = -10.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.714 deg
};
P[28]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = -10.000 mm, Y = -17.321 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[29]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 0.000 mm, Y = -20.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.427 deg
};
P[30]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 10.000 mm, Y = -17.321 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.504 deg
};
P[31]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 17.321 mm, Y = -10.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 66.714 deg
};
P[32]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 20.000 mm, Y = 0.000 mm, Z = 0.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[33]{
   GP1:
    UF : 1, UT : 2,  CONFIG : 'N U T, 0, 0, 0',
    X = 20.000 mm, Y = 0.000 mm, Z = 50.000 mm,
    W = 0.000 deg, P = 0.000 deg, R = 67.000 deg
};
P[34]{
   GP1:
    UF : 1, UT : 2,
    J1 = -5.000 deg, J2 = -5.000 deg, J3 = -5.000 deg,
    J4 = 10.000 deg, J5 = -20.000 deg, J6 = -10.000 deg
};
P[35]{
   GP1:
    UF : 1, UT : 2,
    J1 = 0.000 deg, J2 = 0.000 deg, J3 = 0.000 deg,
    J4 = 0.000 deg, J5 = 0.000 deg, J6 = 0.000 deg
};
/END

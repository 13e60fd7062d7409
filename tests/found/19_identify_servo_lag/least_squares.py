# least squares of free runs from rest with the equations of full.toml, integrated independently of appell
import numpy as np
runs=[np.genfromtxt(f'run{i}.csv',delimiter=',',names=True) for i in (1,2,3)]
Y=np.array([d['q'] for d in runs]).T; U=np.array([d['cmd'] for d in runs])
def sim(P):  # a lane for each list of parameters and run
    Ja,dv,f,lag=np.repeat(np.array(P),3,axis=0).T; I=.4*.125**2+.0025995+Ja; h=.0005
    u=np.tile(U,(len(P),1)); y=np.zeros((3,u.shape[0])); out=[]
    def rhs(y,u):
        q,v,a=y; return np.array([v,(12*(a-q)-.3*v-dv*v-f*np.tanh(v/.01)-.4*9.81*.125*np.sin(q))/I,(u-a)/lag])
    for k in range(u.shape[1]):
        out.append(y[0])
        for _ in range(20):
            k1=rhs(y,u[:,k]);k2=rhs(y+h/2*k1,u[:,k]);k3=rhs(y+h/2*k2,u[:,k]);k4=rhs(y+h*k3,u[:,k]); y=y+h/6*(k1+2*k2+2*k3+k4)
    return np.array(out)
p=np.array([.012,.08,.15,.04]); step=np.array([1e-5,1e-4,1e-4,1e-5])
for _ in range(4):
    o=sim([p]+[p+step*one for one in np.eye(4)])
    left=(Y-o[:,:3]).ravel(); J=np.array([((o[:,3*i+3:3*i+6]-o[:,:3])/step[i]).ravel() for i in range(4)]).T
    print(p,'rms',np.sqrt(np.mean(left**2)))
    p=p+np.linalg.lstsq(J,left,rcond=None)[0]
# [0.012 0.08 0.15 0.04] rms 0.00134, then [0.01236 0.0791 0.1489 0.0401] rms 0.00112
